"""A PostgreSQL server of one's own, from where Debian puts it, and certificates for it and for others."""

import os
import pwd
import secrets
import subprocess
import sys
from pathlib import Path

from served import free_port

# Whoever comes over a network speaks TLS and knows the password.
ONLY_TLS = "local all all trust\nhostssl all all 127.0.0.1/32 scram-sha-256\n"


class Authority:
    """Whom alone to believe: makes certificates."""

    def __init__(self, folder: Path, name: str):
        self.folder, self.name = folder, name
        self.file, self.key = folder / f"{name}.pem", folder / f"{name}.key"
        self.run("req", "-x509", "-days", "2", "-subj", f"/CN={name}", "-out", self.file, *self.new_key(self.key))

    @staticmethod
    def new_key(file: Path) -> list:
        return ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", file]

    @staticmethod
    def run(*arguments):
        done = subprocess.run(["openssl", *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == 0, f"openssl {arguments}: {done.stderr}"

    def certify(self, name: str, names: str) -> tuple[Path, Path]:
        """A certificate and its key for a server of these names, such as `DNS:localhost`."""
        certificate, key, request = (self.folder / f"{name}.{end}" for end in ("pem", "key", "csr"))
        self.run("req", "-subj", f"/CN={name}", "-out", request, *self.new_key(key))
        extensions = self.folder / f"{name}.extensions"
        extensions.write_text(f"subjectAltName={names}\n")
        self.run("x509", "-req", "-in", request, "-CA", self.file, "-CAkey", self.key, "-days", "2", "-CAcreateserial",
                 "-extfile", extensions, "-out", certificate)
        return certificate, key


class Postgres:
    """A server in a folder. With an authority it speaks TLS under the name localhost alone, and asks for a
    password; without, it believes everybody on this machine."""

    def __init__(self, folder: Path, authority: Authority | None = None):
        found = sorted(Path("/usr/lib/postgresql").glob("*/bin/postgres"), key=lambda path: int(path.parts[4]))
        if not found:
            sys.exit("PostgreSQL is not there: apt-get install postgresql")
        self.programs, self.folder, self.port = found[-1].parent, folder / "postgres", free_port()
        self.data = self.folder / "data"
        self.folder.mkdir()
        self.user, owner = [], None
        if os.geteuid() == 0:
            owner = pwd.getpwnam("postgres")
            self.user = ["setpriv", f"--reuid={owner.pw_uid}", f"--regid={owner.pw_gid}", "--clear-groups"]
            os.chown(self.folder, owner.pw_uid, owner.pw_gid)
            folder.chmod(0o711)
        self.run("initdb", "-D", self.data, "-A", "trust", "-U", "lab", "-E", "UTF8", "--locale=C.UTF-8", "--no-sync")
        options = f"-k {self.folder} -p {self.port} -c listen_addresses=127.0.0.1 -c max_connections=400"
        if authority:
            for file in authority.certify("database", "DNS:localhost"):
                own = self.data / file.name
                own.write_bytes(file.read_bytes())
                own.chmod(0o600)
                if owner:
                    os.chown(own, owner.pw_uid, owner.pw_gid)
            (self.data / "pg_hba.conf").write_text(ONLY_TLS)
            options += " -c ssl=on -c ssl_cert_file=database.pem -c ssl_key_file=database.key"
        self.run("pg_ctl", "-D", self.data, "-l", self.folder / "log", "-w", "-o", options, "start")
        self.run("createdb", *self.here, "lab")
        self.url = f"postgres://lab@127.0.0.1:{self.port}/lab"
        if authority:
            self.password = secrets.token_hex(16)
            self.ask(f"ALTER ROLE lab PASSWORD '{self.password}'")
            self.url = self.secured(f"sslmode=verify-full&sslrootcert={authority.file}")

    @property
    def here(self) -> list:
        return ["-h", self.folder, "-p", self.port, "-U", "lab"]

    def secured(self, options: str, host: str = "localhost") -> str:
        """Its address with the password."""
        return f"postgres://lab:{self.password}@{host}:{self.port}/lab?{options}"

    def run(self, program: str, *arguments) -> str:
        command = [*self.user, str(self.programs / program), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, close_fds=True,
                              stdin=subprocess.DEVNULL) if program != "pg_ctl" else None
        if done is None:
            # what it starts keeps its output open
            with open(self.folder / "pg_ctl.log", "ab") as log:
                done = subprocess.run(command, stdout=log, stderr=log, cwd=self.folder, stdin=subprocess.DEVNULL)
        assert done.returncode == 0, f"{program}: {done.stderr or (self.folder / 'pg_ctl.log').read_text()}"
        return done.stdout or ""

    def ask(self, text: str) -> str:
        return self.run("psql", *self.here, "-d", "lab", "-Atc", text).strip()

    @property
    def process(self) -> int:
        """That which has started all others."""
        return int((self.data / "postmaster.pid").read_text().split()[0])

    def completed_twice(self) -> int:
        """Jobs of which more than one attempt was completed."""
        return int(self.ask("""SELECT COUNT(*) FROM (SELECT job FROM attempts WHERE end_reason = 'completed'
                                                     GROUP BY job HAVING COUNT(*) > 1) twice"""))

    def lost(self) -> int:
        """Attempts whose worker was thought dead."""
        return int(self.ask("SELECT COUNT(*) FROM attempts WHERE end_reason = 'lost'"))

    def end(self):
        self.run("pg_ctl", "-D", self.data, "-m", "immediate", "stop")
