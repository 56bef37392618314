# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are read, and files that are complete or not there (docs/output-files.md)."""
import contextlib
import errno
import itertools
import os
import re
import shutil
import sys
import time

from refused import Refused

LONGEST_NAME = 255  # bytes
unfinished = []  # what an interrupt removes
complete = []
numbers = itertools.count()


def with_bytes(text):
    """Half characters, of which no bytes can be made, as \\ud800; those that stand for bytes of file names stay."""
    return "".join(f"\\u{ord(c):04x}" if 0xd800 <= ord(c) < 0xdc80 or 0xdd00 <= ord(c) < 0xe000 else c for c in text)


def one_line(text):
    """Control characters as \\n and \\x1b, as lib/pamr/base/one_line.cpp has it."""
    return "".join("\\n" if c == "\n" else f"\\x{ord(c):02x}" if ord(c) < 0x20 or 0x7f <= ord(c) < 0xa0 else c
                   for c in with_bytes(text))


def as_unicode(text):
    """File names need not be UTF-8; JSON and the texts of a picture must be."""
    return with_bytes(text).encode(errors="surrogateescape").decode(errors="replace")


def keep_standard_streams():
    """As tools/cli/standard_output.cpp: no file takes the number of a closed stream, and with it what is said there."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDONLY if number else os.O_WRONLY)


def say(text, is_report=False):
    """Prints a line that has to arrive. Where there is no standard output nobody listens, but for a report."""
    try:
        if sys.stdout is None:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        print(text, flush=True)
    except OSError as wrong:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # else Python tries once more when it ends
        if is_report:
            raise Refused("standard output: the report cannot be written") from None
        if wrong.errno != errno.EBADF:
            raise Refused(f"standard output: not all that was printed could be written: {wrong.strerror}") from None


def tell(text):
    """A line of standard error, which nobody has to read."""
    with contextlib.suppress(OSError):
        os.write(2, os.fsencode(one_line(text) + "\n"))


def complete_text():
    """The end of every message once an output is complete."""
    return f"; complete: {', '.join(repr_of(path) for path in complete)}" if complete else ""


def repr_of(path):
    return f"'{one_line(path)}'"


def is_same_file(a, b):
    """By `.` and `..`, symbolic or hard links; they need not exist. As tools/cli/files.cpp has it."""
    def entry(path):
        return os.path.join(os.path.realpath(os.path.dirname(path) or "."), os.path.basename(path))
    return (entry(a) == entry(b) or os.path.realpath(a) == os.path.realpath(b)
            or os.path.exists(a) and os.path.exists(b) and os.path.samefile(a, b))


def is_device(path):
    return os.path.exists(path) and not os.path.isfile(path) and not os.path.isdir(path)


def check_input(path):
    """As tools/cli/output_file.cpp."""
    if not os.path.exists(path):
        raise Refused(f"{path}: expected an input file, found nothing of that name")
    if is_device(path):
        raise Refused(f"{path}: expected an input file, found a device or pipe")
    if not os.access(path, os.R_OK):
        raise Refused(f"{path}: cannot be read: {os.strerror(errno.EACCES)}")


def check_output(path, inputs, outputs, force=True):
    """Refuses what cannot become this output; before work starts, for each output."""
    if is_device(path):
        return
    for kind, others in (("input", inputs), ("output", outputs)):
        for other in others:
            if is_same_file(path, other):
                raise Refused(f"{path}: expected an output of its own, found the same file as the {kind} {other}")
    folder = os.path.dirname(path) or "."
    if os.path.isdir(path):
        raise Refused(f"{path}: expected a file to write, found a folder")
    if not os.path.isdir(folder):
        raise Refused(f"{path}: expected an existing folder to write into, found none named {folder}")
    if not os.access(folder, os.W_OK | os.X_OK):
        reason = errno.EROFS if os.statvfs(folder).f_flag & os.ST_RDONLY else errno.EACCES
        raise Refused(f"{path}: the folder {folder} cannot be written: {os.strerror(reason)}")
    if os.path.exists(path) and not force:
        raise Refused(f"{path}: the output file exists already (--force replaces it)")
    remove_leftovers(path, inputs)


def text_of(file):
    """Empty where the system does not tell."""
    try:
        with open(file, encoding="utf-8", errors="replace") as opened:
            return opened.read()
    except OSError:
        return ""


def machine():
    """The running system and its namespace of processes, by the hash of lib/pamr/base/process.cpp."""
    low = (1 << 64) - 1

    def mix(x):
        x = x + 0x9e3779b97f4a7c15 & low
        x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9 & low
        x = (x ^ x >> 27) * 0x94d049bb133111eb & low
        return x ^ x >> 31
    words = (text_of("/proc/sys/kernel/random/boot_id") or os.uname().nodename).encode()
    with contextlib.suppress(OSError):
        words += os.readlink("/proc/self/ns/pid").encode()
    result = 0
    for word in words:
        result = mix(result ^ mix(word))
    return result >> 32


def state_and_start(process):
    """Fields 3 and 22 of /proc/N/stat."""
    fields = text_of(f"/proc/{process}/stat").rpartition(") ")[2].split()
    return (fields[0], int(fields[19])) if len(fields) > 19 else ("?", 0)


def unfinished_name(path):
    folder, name = os.path.split(path)
    host = re.sub("[^0-9A-Za-z-]", "_", os.uname().nodename[:32]) or "host"
    tail = f".{host}-{machine():08x}-{os.getpid()}-{state_and_start('self')[1]}-{next(numbers)}.partial"
    while len(os.fsencode(name + tail)) > LONGEST_NAME:
        name = name[:-1]
    return os.path.join(folder, name + tail)


def has_ended(of_machine, process, start, path):
    """Whether nobody writes a temporary file any more."""
    if int(of_machine, 16) != machine():
        return time.time() - os.lstat(path).st_mtime > 86400
    if not os.path.exists(f"/proc/{process}"):
        return True
    state, began = state_and_start(process)
    return state == "Z" or int(start) not in (0, began)


def remove_leftovers(path, keep):
    """Temporary files of this output whose process was killed."""
    folder, name = os.path.split(path)
    names = []
    with contextlib.suppress(OSError):  # a folder may be written that cannot be listed
        names = os.listdir(folder or ".")
    for found in names:
        parts = re.fullmatch(r"(.*)\.[^.]*-([0-9a-f]+)-(\d+)-(\d+)-\d+\.partial", found, re.DOTALL)
        is_cut = len(os.fsencode(found)) + 4 > LONGEST_NAME
        if not parts or not (parts[1] == name or is_cut and parts[1] and name.startswith(parts[1])):
            continue
        left = os.path.join(folder, found)
        with contextlib.suppress(OSError):
            if os.path.isfile(left) and has_ended(*parts.groups()[1:], left) and not any(is_same_file(left, k) for k in keep):
                os.unlink(left)


def set_rights(descriptor, rights):
    """As lib/pamr/io/rights_of.cpp: who may not give a file to another owner may give it to one of the own groups."""
    made = os.fstat(descriptor)
    try:
        os.fchown(descriptor, rights.st_uid, rights.st_gid)
    except OSError:
        with contextlib.suppress(OSError):
            os.fchown(descriptor, made.st_uid, rights.st_gid)
    os.fchmod(descriptor, rights.st_mode & 0o777)


def remove(path):
    if os.path.isdir(path) and not os.path.islink(path):
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            os.unlink(path)


@contextlib.contextmanager
def refused_as(words):
    """The error of a system call that is to fail with these words."""
    try:
        yield
    except OSError as wrong:
        raise Refused(f"{words}: {wrong.strerror}") from None


def write_all(file, content):
    while content:
        content = content[file.write(content):]


def write_whole(path, content):
    """All of it or nothing arrives under the name; a device or pipe is written directly. The words of an error are
    those of lib/pamr/io/partial_file.cpp."""
    if is_device(path):
        with refused_as(f"{path}: cannot be opened for writing"):
            device = os.open(path, os.O_WRONLY)
        with refused_as(f"{path}: cannot be written"), open(device, "wb", buffering=0) as file:
            write_all(file, content)
        return
    partial, name = unfinished_name(path), f"file '{path}'"
    unfinished.append(partial)
    try:
        with refused_as(f"{name}: cannot create it"):
            rights = os.stat(path) if os.path.exists(path) else None
            # nobody else reads it before it has the rights of the old one
            flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            made = os.open(partial, flags, 0o600 if rights else 0o666)
        with open(made, "wb", buffering=0) as file:
            with refused_as(f"{name}: cannot write it"):
                write_all(file, content)
            with refused_as(f"{name}: cannot give it the rights of the file that it replaces"):
                if rights:
                    set_rights(made, rights)
            with refused_as(f"{name}: cannot flush it to the disk"):
                os.fsync(made)
        with refused_as(f"{name}: cannot rename it when complete"):
            os.replace(partial, path)
        complete.append(path)
    finally:
        remove(partial)
        unfinished.remove(partial)
