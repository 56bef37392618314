# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the tables of the performance reports: report.sh --help says how it is used."""

import argparse
import datetime
import pathlib
import re
import subprocess
import sys
import time

import tables
from measure import Bench, Failed, load
from peers import Peers

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIMIT_SIZE = {"whole": 55, "quick": 55, "tiny": 20}
REPEATS = {"whole": (5, 20), "quick": (2, 5), "tiny": (1, 0)}  # at most, and no further one after so many seconds


class Context:
    """The sources of the tables."""

    def __init__(self, options):
        self.build = options.build.resolve()
        self.size = "tiny" if options.tiny else "quick" if options.quick else "whole"
        self.out = (options.out or self.build / "bench/report").resolve() / self.size
        self.peers = Peers((options.peer_folder or self.build / "bench/peers").resolve())
        self.names = options.peers.split() if options.peers is not None else list(self.peers.all)
        self.environment = tables.environment()
        self.bench = Bench(self.build, LIMIT_SIZE[self.size], *REPEATS[self.size])
        self.commit = commit()


def commit():
    """Of the source, short, with a word where it has changes."""

    def git(*words):
        return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=False).stdout.strip()

    name = git("rev-parse", "--short", "HEAD") or "unknown"
    return name + (" with changes" if git("status", "--porcelain", "--untracked-files=no") else "")


def machine():
    info = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    models = re.findall(r"^model name\s*: (.*)$", info, re.MULTILINE)
    return f"{models[0] if models else 'unknown processor'}, {info.count('processor	:')} cores"


def refuse(text):
    print(f"report.sh: {text}", file=sys.stderr)
    sys.exit(2)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="report.sh", add_help=False)
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build/release")
    for name in ("quick", "tiny", "again", "into-docs", "list"):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("--table", action="append", default=[])
    for name in ("out", "peer-folder", "docs"):
        parser.add_argument(f"--{name}", type=pathlib.Path)
    parser.add_argument("--peers")
    parser.error = lambda message: refuse(f"{message} (see report.sh --help)")
    options = parser.parse_args(arguments)
    for name in options.table:
        if name not in tables.TABLES:
            refuse(f"expected tables among {' '.join(tables.TABLES)}, found {name}")
    unknown = set((options.peers or "").split()) - set(Peers(".").all)
    if unknown:
        refuse(f"expected peers among {' '.join(Peers('.').all)}, found {' '.join(sorted(unknown))}")
    if not options.list and not (options.build / "bench/bench_peer").exists():
        refuse(f"no {options.build}/bench/bench_peer: build with -DPAMR_BENCH=ON first")
    return options


def file_of(context, name):
    return context.out / f"{name}.md"


def is_made(context, name):
    """Whether the table is there, of this commit."""
    path = file_of(context, name)
    return path.exists() and f"commit {context.commit}," in path.read_text(encoding="utf-8").splitlines()[0]


def without_folders(text, context):
    """Pages name no folder of the machine."""
    for folder, word in ((context.out, "OUT"), (context.build, "BUILD"), (ROOT, "PAMR")):
        text = text.replace(str(folder), word)
    return text


def make(context, name):
    """Writes a table as soon as it is complete; False where it could not be made."""
    before = load()
    try:
        limit = context.bench.limit()
        lines = tables.TABLES[name].make(context)
    except Failed as error:
        print(f"report.sh: {name}: {error}", file=sys.stderr)
        return False
    peers = "" if context.names == list(context.peers.all) else f" --peers \"{' '.join(context.names)}\""
    size = "" if context.size == "whole" else f" --{context.size}"
    heading = (
        f"{datetime.date.today()}, commit {context.commit}, {machine()}, `limit` {limit:.1f}, load {before:.2f} before "
        f"and {load():.2f} after. Command: `bench/report.sh{size} --table {name}{peers}`."
    )
    unready = file_of(context, name).with_suffix(".unready")
    text = without_folders("\n".join([heading, "", *lines]), context)
    unready.write_text(text.rstrip() + "\n", encoding="utf-8")
    unready.rename(file_of(context, name))
    return True


def insert(text, page):
    """A page with the text of tables between their marks: `<!-- table NAME -->` and `<!-- end of table NAME -->`."""
    for name, content in text.items():
        begin, end = f"<!-- table {name} -->\n", f"<!-- end of table {name} -->"
        if begin in page and end in page:
            head, _, rest = page.partition(begin)
            page = head + begin + "\n" + content + "\n" + end + rest.partition(end)[2]
    return page


def write_into_docs(context, names, folder):
    text = {name: file_of(context, name).read_text(encoding="utf-8") for name in names}
    for page in sorted({tables.TABLES[name].page for name in names}):
        path = folder / f"{page}.md"
        old = path.read_text(encoding="utf-8")
        new = insert(text, old)
        if new != old:
            path.write_text(new, encoding="utf-8")
            print(f"report.sh: wrote tables into {path}", file=sys.stderr)
    for name in names:
        path = folder / f"{tables.TABLES[name].page}.md"
        if f"<!-- table {name} -->" not in path.read_text(encoding="utf-8"):
            print(f"report.sh: {path} has no place for the table {name}", file=sys.stderr)


def main(arguments):
    options = parse(arguments)
    names = options.table or list(tables.TABLES)
    if options.list:
        print(
            "\n".join(
                f"{name:18} {tables.TABLES[name].title} (docs/reports/{tables.TABLES[name].page}.md)" for name in names
            )
        )
        return 0
    context = Context(options)
    context.out.mkdir(parents=True, exist_ok=True)
    made = []
    for name in names:
        if options.again or not is_made(context, name):
            print(f"report.sh: {name}", file=sys.stderr)
            began = time.monotonic()
            if not make(context, name):
                continue
            print(f"report.sh: {name} took {time.monotonic() - began:.0f} s", file=sys.stderr)
        made.append(name)
        print(f"## {tables.TABLES[name].title}\n\n{file_of(context, name).read_text(encoding='utf-8')}", flush=True)
    if options.into_docs:
        write_into_docs(context, made, options.docs or ROOT / "docs/reports")
    return 0 if made == names else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
