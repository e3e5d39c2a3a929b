"""Two servers of a lab behind nginx, with the configuration that the guide shows: TLS from clients to nginx and
from servers to PostgreSQL, files in a bucket, a data folder for each server. Played by `tests/postgres proxy`."""

import os
import random
import shutil
import ssl
import sys
import time
import urllib.request
from pathlib import Path

from private_postgres import Authority, Postgres
from served import (GONE, LEASE_S, ROOT, Follower, Processes, Servers, Submissions, Way, command, free_port, references,
                    say, until)

CONFIGURATION = ROOT / "server" / "deploy" / "nginx.conf"
TOKEN = "a-token-of-this-play-alone-0123456789"
PASSWORD = "a password of this play alone"
SEEDS = 3
# What nginx needs around the file of the lab. `x-upstream` tells which server answered.
AROUND = """
daemon off;
worker_processes 1;
pid {folder}/nginx.pid;
error_log {folder}/nginx-errors.log;
{user}
events {{ worker_connections 1024; }}
http {{
    access_log {folder}/nginx-access.log;
    add_header x-upstream $upstream_addr always;
    client_body_temp_path {folder}/nginx-body;
    proxy_temp_path {folder}/nginx-proxy;
    fastcgi_temp_path {folder}/nginx-fastcgi;
    uwsgi_temp_path {folder}/nginx-uwsgi;
    scgi_temp_path {folder}/nginx-scgi;
    include {folder}/lab.conf;
}}
"""


class Bucket(Processes):
    """A real S3 server that keeps everything in its memory."""

    KEYS = ("a-key-of-this-play", "and-its-secret")

    def __init__(self, folder: Path):
        super().__init__(folder)
        port = free_port()
        self.endpoint = f"http://127.0.0.1:{port}"
        self.spawn("s3", [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", port])

        def is_made():
            try:
                request = urllib.request.Request(f"{self.endpoint}/lab", method="PUT")
                with urllib.request.urlopen(request, timeout=5) as answer:
                    return answer.status == 200
            except GONE:
                return False

        until("there is a bucket", is_made, 60)
        self.keys = folder / "keys"
        self.keys.write_text("\n".join(self.KEYS))
        self.keys.chmod(0o600)

    @property
    def options(self) -> list:
        return ["--files", "s3://lab/one", "--files-endpoint", self.endpoint, "--files-keys", self.keys]


class Nginx(Processes):
    """nginx before two servers, and clients of it at many addresses."""

    def __init__(self, folder: Path, authority: Authority, ports: list[int]):
        super().__init__(folder)
        if not shutil.which("nginx"):
            sys.exit("nginx is not there: apt-get install nginx-light")
        self.port = free_port()
        certificate, key = authority.certify("proxy", "DNS:localhost")
        text = CONFIGURATION.read_text()
        for told, here in [("server lab1:8400 ", f"server 127.0.0.1:{ports[0]} "),
                           ("server lab2:8400 ", f"server 127.0.0.1:{ports[1]} "),
                           ("listen 443 ssl;", f"listen 127.0.0.1:{self.port} ssl;"),
                           ("/etc/nginx/tls/lab.pem", str(certificate)), ("/etc/nginx/tls/lab.key", str(key))]:
            assert text.count(told) == 1, told
            text = text.replace(told, here)
        (folder / "lab.conf").write_text(text)
        around = AROUND.format(folder=folder, user="user root;" if os.geteuid() == 0 else "")
        (folder / "nginx.conf").write_text(around)
        self.spawn("nginx", ["nginx", "-p", folder, "-c", folder / "nginx.conf"])
        self.address = f"https://localhost:{self.port}"
        trust = ssl.create_default_context(cafile=str(authority.file))
        self.ways = [Way(self.port, "localhost", f"127.0.0.{last}", trust, TOKEN) for last in range(2, 22)]
        until("nginx answers", lambda: self.ways[0].call("GET", "/readyz").status, 30)

    def of_each(self, ports: list[int]) -> list[Way]:
        """A client of each server."""
        led = {}
        for way in self.ways:
            answer = way.call("GET", "/readyz")
            assert answer.status == 200, answer
            led.setdefault(answer.headers["x-upstream"], way)
        assert set(led) == {f"127.0.0.1:{port}" for port in ports}, led
        return [led[f"127.0.0.1:{port}"] for port in ports]


def refused_connections(folder: Path, postgres: Postgres, authority: Authority, stranger: Authority):
    """Commands reach the database by the right certificate alone, and no password is in what they say."""
    whole = f"sslmode=verify-full&sslrootcert={authority.file}"
    for what, address, sentence in [
        ("by its authority", postgres.secured(whole), None),
        ("without its authority", postgres.secured("sslmode=verify-full"), "certificate"),
        ("by another authority", postgres.secured(f"sslmode=verify-full&sslrootcert={stranger.file}"), "certificate"),
        ("under another name", postgres.secured(whole, host="127.0.0.1"), "certificate"),
        ("in the clear", postgres.secured("sslmode=disable"), "no encryption"),
    ]:
        file = folder / "address"
        file.write_text(address)
        file.chmod(0o600)
        said = command("token", "list", "--data", folder / "beside", "--database-file", file, fails=sentence is not None)
        assert sentence is None or sentence in said, (what, said)
        assert postgres.password not in said, what
        say(f"PostgreSQL {what}: {'reached' if sentence is None else 'refused: ' + said.strip().splitlines()[-1]}")


def proxy(folder: Path, chance: random.Random, jobs: int, kills: int):
    authority, stranger = Authority(folder, "authority"), Authority(folder, "stranger")
    alone = references(folder, SEEDS)
    started = []
    postgres = Postgres(folder, authority)
    try:
        refused_connections(folder, postgres, authority, stranger)
        started.append(bucket := Bucket(folder))
        address = folder / "database"
        address.write_text(postgres.url)
        address.chmod(0o600)
        options = ["--database-file", address, "--require-token", *bucket.options]
        started.append(lab := Servers(folder, options, apart=True, LOADFRAME_TOKEN=TOKEN))
        lab.serve_both()
        started.append(nginx := Nginx(folder, authority, lab.ports))
        play(folder, chance, jobs, kills, alone, postgres, lab, nginx, authority)
        sign_in(lab, nginx, address)
        said = command("scrub", "--data", lab.data(0), "--database-file", address, *bucket.options)
        say(f"scrub: {said.strip().splitlines()[-1]}")
    finally:
        for one in reversed(started):
            one.end()
        postgres.end()


def play(folder, chance, jobs, kills, alone, postgres: Postgres, lab: Servers, nginx: Nginx, authority: Authority):
    ways = nginx.of_each(lab.ports)
    followers = [Follower(way) for way in ways]
    sent = Submissions(nginx.ways, chance, SEEDS)
    # what one is told the other one tells at once, and the proxy keeps nothing back
    begin = time.monotonic()
    first = sent.submit(0, ways[0])
    until("the other server tells of it", lambda: followers[1].numbers, 10, every=0.002)
    told_after = time.monotonic() - begin
    assert told_after < 3, f"the proxy kept an event back for {told_after:.1f} s"
    say(f"a job submitted through one server is told through the other after {1000 * told_after:.0f} ms")
    assert ways[1].call("GET", f"/v1/jobs/{first}").json()["id"] == first
    # what is too large for the server is refused by the server, not by nginx
    large = ways[0].call("POST", "/v1/jobs", b"[" + b" " * (3 << 20) + b"]")
    assert large.headers.get("content-type") == "application/problem+json", large
    workers = [lab.worker(name, nginx.address, "--ca", authority.file) for name in ("one", "two")]

    submitting = sent.begin(range(1, jobs))
    moved = 0
    for number in range(kills):
        time.sleep(chance.uniform(0.5, 3))
        which = number % 2
        lab.kill(which)
        # of what begins now nothing finds the dead one
        for way in nginx.ways:
            answer = way.call("GET", "/readyz")
            assert answer.status == 200, answer
            moved += "," in answer.headers["x-upstream"]
        time.sleep(chance.uniform(0, 2))
        lab.serve(which)
    submitting.join()
    assert moved, "no client was ever moved"

    # both are away for longer than a lease: workers compute on
    waiting = sent.begin(range(jobs, jobs + 6))
    waiting.join()
    for which in (0, 1):
        lab.kill(which)
    time.sleep(LEASE_S + 4)
    assert ways[0].call("GET", "/readyz").status == 502
    assert all(worker.poll() is None for worker in workers)
    lab.serve_both()

    sent.all_end(followers, alone)
    assert all(follower.cut and not follower.whole for follower in followers), \
        [(follower.cut, follower.whole) for follower in followers]
    assert postgres.completed_twice() == 0
    open_ones = postgres.ask("""SELECT COUNT(*) FILTER (WHERE ssl), COUNT(*) FILTER (WHERE NOT ssl) FROM pg_stat_ssl
                                JOIN pg_stat_activity USING (pid) WHERE client_addr IS NOT NULL""")
    over_tls, in_the_clear = map(int, open_ones.split("|"))
    assert over_tls > 0 and in_the_clear == 0, open_ones
    for worker in workers:
        worker.terminate()
        assert worker.wait(timeout=60) == 0
    say(f"{len(sent.seed_of)} jobs, {kills + 2} times a server was killed; {sent.told()}; {moved} requests of clients "
        f"were led to the other server; {postgres.lost()} attempts lost; both streams told every end, in order, cut "
        f"{' and '.join(str(follower.cut) for follower in followers)} times and each time noticed; all succeeded once, "
        f"with the bytes of a run alone; {over_tls} connections to PostgreSQL, all over TLS")


def sign_in(lab: Servers, nginx: Nginx, address: Path):
    """A session that begins at one server is good at the other, from pages of the proxy's address alone."""
    password = lab.folder / "password"
    password.write_text(PASSWORD)
    password.chmod(0o600)
    command("people", "create-admin", "Anna", "--password-file", password, "--data", lab.data(0),
            "--database-file", address)
    ways = nginx.of_each(lab.ports)
    for way in ways:
        way.token = None
    own = {"origin": nginx.address}
    for way in ways:
        until("a server knows that there are people", lambda: b"sign-in-needed" in way.call("GET", "/v1/jobs").body, 30)
    answer = ways[0].call("POST", "/v1/sessions", {"name": "Anna", "password": PASSWORD}, own)
    assert answer.status == 204, answer
    cookie = answer.headers["set-cookie"].split(";")[0]
    project = {"name": "a project", "visibility": "private"}
    for origin, expected in [("https://localhost", 403), ("https://elsewhere.example", 403), (nginx.address, 201)]:
        answer = ways[1].call("POST", "/v1/projects", project, {"cookie": cookie, "origin": origin})
        assert answer.status == expected, (origin, answer)
    say("a session that began at one server is good at the other, for pages under the proxy's address alone")
