"""What plays with real servers share: waiting, addresses, a job, who asks and who follows events."""

import hashlib
import http.client
import json
import os
import socket
import ssl
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
EXAMPLE = ROOT / "api" / "examples" / "nonwoven_tensile_quick.json"
LEASE_S = 3.0
NEVER_S = 240.0
# What a client sees of a server that was killed or does not listen.
GONE = (OSError, http.client.HTTPException)


def say(text: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {text}", flush=True)


def until(what: str, condition, longest: float = NEVER_S, every: float = 0.05):
    begin = time.monotonic()
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() - begin > longest:
            raise AssertionError(f"never came true: {what}")
        time.sleep(every)


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def binary() -> str:
    path = os.environ.get("LOADFRAME_BIN", str(TARGET / "release" / "loadframe"))
    if not Path(path).exists():
        sys.exit(f"{path} is not there: build it first")
    return path


def command(*arguments, fails: bool = False, **options) -> str:
    """What loadframe says; it must succeed, or fail."""
    done = subprocess.run([binary(), *map(str, arguments)], capture_output=True, text=True, **options)
    said = done.stdout + done.stderr
    assert (done.returncode != 0) == fails, f"loadframe {arguments} ended with {done.returncode}: {said}"
    return said


def job(seed: int) -> dict:
    body = json.loads(EXAMPLE.read_text())
    body["spec"]["seed"] = seed
    body["spec"]["output"] = {"snapshot_every_steps": 50}
    return body


def references(folder: Path, seeds: int) -> list[dict[str, str]]:
    """SHA-256 of the files of jobs with these seeds, computed without a server."""
    found = []
    for seed in range(seeds):
        out, spec = folder / f"alone-{seed}", folder / f"{seed}.json"
        spec.write_text(json.dumps(job(seed)))
        command("run", spec, "--out", out)
        files = (path for path in out.rglob("*") if path.is_file() and path.name != "outcome.json")
        found.append({str(path.relative_to(out)): sha256(path.read_bytes()) for path in files})
    return found


class Answer(NamedTuple):
    status: int
    headers: dict
    body: bytes

    def json(self):
        return json.loads(self.body)


class Way:
    """How a client reaches a server or a proxy: from which of its addresses, whom it trusts, as whom."""

    def __init__(self, port: int, host: str = "127.0.0.1", source: str | None = None,
                 trust: ssl.SSLContext | None = None, token: str | None = None):
        self.port, self.host, self.trust, self.token = port, host, trust, token
        self.source = (source, 0) if source else None

    def open(self, method: str, path: str, body=None, headers=None, timeout: float = 30):
        """An answer of which only the head has been read."""
        options = {"timeout": timeout, "source_address": self.source}
        if self.trust:
            connection = http.client.HTTPSConnection(self.host, self.port, context=self.trust, **options)
        else:
            connection = http.client.HTTPConnection(self.host, self.port, **options)
        data = body if isinstance(body, bytes) or body is None else json.dumps(body).encode()
        headers = {"connection": "close", **(headers or {})}
        if data is not None:
            headers.setdefault("content-type", "application/json")
        if self.token:
            headers.setdefault("authorization", f"Bearer {self.token}")
        connection.request(method, path, data, headers)
        return connection.getresponse()

    def call(self, method: str, path: str, body=None, headers=None, timeout: float = 30) -> Answer:
        """An answer; status 0 when nobody answers, or not to the end."""
        try:
            with self.open(method, path, body, headers, timeout) as answer:
                return Answer(answer.status, {k.lower(): v for k, v in answer.getheaders()}, answer.read())
        except GONE:
            return Answer(0, {}, b"")


class Processes:
    """What was started here; ended in reverse order."""

    def __init__(self, folder: Path):
        self.folder, self.started = folder, []

    def spawn(self, name: str, arguments, **environment) -> subprocess.Popen:
        with open(self.folder / f"{name}.log", "ab") as log:
            process = subprocess.Popen([str(one) for one in arguments], stdout=log, stderr=log,
                                       env={**os.environ, **environment})
        self.started.append(process)
        return process

    def end(self):
        for process in reversed(self.started):
            if process.poll() is None:
                process.kill()
                process.wait()


class Servers(Processes):
    """Two servers on one database. Each has these options, and a data folder of its own if `apart`."""

    def __init__(self, folder: Path, options: list, apart: bool = False, **environment):
        super().__init__(folder)
        self.ports, self.processes = [free_port(), free_port()], [None, None]
        self.options, self.apart, self.environment = options, apart, environment
        self.ways = [Way(port) for port in self.ports]

    def data(self, which: int) -> Path:
        return self.folder / (f"data-{which}" if self.apart else "data")

    def begin(self, which: int):
        """Starts a server; it may not be ready yet."""
        self.processes[which] = self.spawn(f"server-{which}", [
            binary(), "serve", "--listen", f"127.0.0.1:{self.ports[which]}", "--data", self.data(which),
            "--lease-s", LEASE_S, *self.options], **self.environment)

    def await_ready(self, which: int):
        def is_ready():
            assert self.processes[which].poll() is None, (self.folder / f"server-{which}.log").read_text()[-2000:]
            return self.ways[which].call("GET", "/readyz").status == 200

        until(f"server {which} is ready", is_ready)

    def serve(self, which: int):
        self.begin(which)
        self.await_ready(which)

    def serve_both(self):
        """Starts both at once."""
        for step in (self.begin, self.await_ready):
            for which in (0, 1):
                step(which)

    def kill(self, which: int):
        self.processes[which].kill()
        self.processes[which].wait()

    def worker(self, name: str, address: str, *options) -> subprocess.Popen:
        return self.spawn(name, [binary(), "worker", "--server", address, "--name", name, "--checkpoint-every", "0.5",
                                 "--scratch", self.folder, *options], **self.environment)


def lines(stream):
    """Lines of an answer as they come; fails where it is cut, which the answer's own reader of lines passes over."""
    rest = b""
    while piece := stream.read1(1 << 16):
        *whole, rest = (rest + piece).split(b"\n")
        for line in whole:
            yield line.decode()


class Follower(threading.Thread):
    """Follows all events on a way, and goes on after the last one it has seen when the stream ends."""

    def __init__(self, way: Way, since: int = 0):
        super().__init__(daemon=True)
        self.way, self.last, self.ended, self.numbers = way, since, {}, []
        # streams that ended in order, and those that were cut
        self.whole, self.cut, self.broken = 0, 0, None
        self.start()

    def run(self):
        while True:
            try:
                headers = {"last-event-id": str(self.last), "accept": "text/event-stream"}
                with self.way.open("GET", "/v1/events", None, headers) as stream:
                    if stream.status == 200:
                        self.read(stream)
                        self.whole += 1
                    else:
                        time.sleep(0.1)
            except GONE:
                self.cut += 1
                time.sleep(0.1)

    def read(self, stream):
        number, kind, data = None, None, []
        for line in lines(stream):
            if line.startswith("id:"):
                number = int(line[3:])
            elif line.startswith("event:"):
                kind = line[6:].strip()
            elif line.startswith("data:"):
                data.append(line[5:])
            elif not line and number is not None:
                if number <= self.last:
                    self.broken = f"event {number} came after {self.last}"
                self.last = number
                self.numbers.append(number)
                if kind == "job":
                    job = json.loads("".join(data))
                    if job["status"] == "finished":
                        self.ended[job["id"]] = self.ended.get(job["id"], 0) + 1
                number, kind, data = None, None, []


class Submissions:
    """Jobs that are sent on ways chosen by chance, each until it is accepted, and what must come of them."""

    def __init__(self, ways: list[Way], chance, seeds: int):
        self.ways, self.chance, self.seeds = ways, chance, seeds
        # seeds of accepted jobs; answers to submissions that had to be sent again, by status
        self.seed_of, self.again = {}, {}

    def submit(self, number: int, way: Way | None = None) -> str:
        headers = {"idempotency-key": f"job-{number}"}
        seed = number % self.seeds
        while True:
            answer = (way or self.chance.choice(self.ways)).call("POST", "/v1/jobs", job(seed), headers)
            if answer.status in (200, 201):
                identity = answer.json()["id"]
                self.seed_of[identity] = seed
                return identity
            assert answer.status in (0, 502, 503), answer
            self.again[answer.status] = self.again.get(answer.status, 0) + 1
            time.sleep(0.05)

    def begin(self, numbers) -> threading.Thread:
        def all_of_them():
            for number in numbers:
                self.submit(number)
                time.sleep(self.chance.uniform(0, 0.2))

        thread = threading.Thread(target=all_of_them)
        thread.start()
        return thread

    def states(self) -> list[dict]:
        answer = self.chance.choice(self.ways).call("GET", "/v1/jobs?limit=200")
        assert answer.status in (0, 200, 502, 503), answer
        return answer.json()["items"] if answer.status == 200 else []

    def all_end(self, followers: list[Follower], references: list[dict[str, str]]):
        """All end, once each, with the bytes of runs alone, and all followers are told."""
        count = len(self.seed_of)
        is_finished = lambda jobs: len(jobs) == count and all(one["status"] == "finished" for one in jobs)
        until("all jobs have ended", lambda: is_finished(self.states()), every=0.5)
        ended = {one["id"]: one for one in until("they are listed", self.states)}
        assert set(ended) == set(self.seed_of), "no job twice, none lost"
        wrong = {identity: one["reason"] for identity, one in ended.items() if one["outcome"] != "succeeded"}
        assert not wrong, wrong
        for follower in followers:
            until("every end was told", lambda: set(follower.ended) == set(ended), 30)
            assert follower.broken is None, follower.broken
        for identity, seed in self.seed_of.items():
            way = self.chance.choice(self.ways)
            listed = way.call("GET", f"/v1/jobs/{identity}/files").json()
            listed = listed["items"] if isinstance(listed, dict) else listed
            got = {file["name"]: file["sha256"] for file in listed}
            assert "curve.csv" in got, got
            for name, reference in references[seed].items():
                if name in got:
                    assert got[name] == reference, (identity, name)
                    content = way.call("GET", f"/v1/jobs/{identity}/files/{name}").body
                    assert sha256(content) == reference, (identity, name)

    def told(self) -> str:
        again = ", ".join(f"{times} after {status or 'no answer'}" for status, times in sorted(self.again.items()))
        return f"submissions sent again: {again or 'none'}"
