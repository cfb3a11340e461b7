#!/usr/bin/env python3
"""Holds the arrows between rooms and the doors of third-party libraries against every #include.

The rooms and their arrows are the room() lines of CMakeLists.txt; what they cannot say (doors, the tools'
arrows, what kernels and the pipeline must do without) stands in the tables below. One line per violation,
file:line: what and why; exit 1 if there is any.
"""
import argparse
import os
import re
import sys
from fnmatch import fnmatch
from pathlib import Path
from typing import NamedTuple

SOURCE_FOLDERS = ("pipeline", "drivers", "daemon", "tools")
SOURCE_SUFFIXES = (".cpp", ".hpp", ".h", ".c")

# Programs and benchmarks are no rooms: the first matching folder says what they may include.
PROGRAMS = {
    "tools/povslam": ["base", "geometry", "frames", "pipeline", "drivers", "tools/povslam/*", "pipeline/backend/smooth.hpp",
                      "daemon/app.hpp", "daemon/config_*.hpp", "daemon/store.hpp", "daemon/messages/*",
                      "daemon/stop_signal.hpp"],
    "tools": ["*"],
}

# Header of a library -> the only files that may include it (tools/bench and tools/experiments may include any).
DOORS = [
    ("ceres/*", ["pipeline/backend/*"]),
    ("opencv2/*", ["pipeline/frontend/*", "pipeline/objects/segment*", "drivers/replay/*", "tools/povslam/*"]),
    ("glog/*", ["pipeline/backend/*"]),  # Ceres' log
    ("yaml-cpp/*", ["drivers/replay/*"]),
    ("png.h", ["drivers/replay/*", "tools/povslam/*"]),
    ("jpeglib.h", ["drivers/replay/*"]),
    ("lcm/*", ["daemon/publisher*", "daemon/label_lcm*", "tools/povslam/*"]),
    ("bot_core/*", ["daemon/publisher*", "daemon/messages*", "tools/povslam/*"]),
    ("povslam/*", ["daemon/publisher*", "daemon/label_lcm*", "daemon/messages*", "tools/povslam/*"]),  # generated from daemon/messages/*.lcm
    ("toml++/*", ["daemon/config_file*"]),
    ("sqlite3.h", ["daemon/store*"]),
    ("systemd/*", ["daemon/service*"]),
    ("spdlog/*", ["pipeline/base/log.hpp", "daemon/*"]),
    ("CLI/*", ["daemon/main.cpp", "tools/povslam/*"]),
    ("nlohmann/*", ["tools/povslam/*"]),
    ("boost/lockfree/*", ["pipeline/base/*"]),
    ("boost/math/*", ["pipeline/objects/*", "pipeline/backend/*"]),
    ("Eigen/*", ["pipeline/*", "drivers/*", "daemon/*", "tools/*"]),
    ("immintrin.h", ["pipeline/frontend/kernels/*", "pipeline/mapping/kernels/*", "pipeline/backend/kernels/*"]),
]
ANY_DOOR = ["tools/bench/*", "tools/experiments/*"]

# Values in, values out: the pipeline has no threads, locks, files or sockets of its own.
NOT_IN_PIPELINE = {"thread", "mutex", "shared_mutex", "condition_variable", "future", "semaphore", "stop_token", "latch",
                   "barrier", "fstream", "iostream", "filesystem", "pthread.h", "fcntl.h", "unistd.h", "sys/socket.h",
                   "sys/mman.h", "netinet/in.h"}
CALLS_NOT_IN_PIPELINE = re.compile(r"\bstd::(j?thread|async)\b|\b(fopen|pthread_create|socket)\s*\(")

# Kernels are compiled for several machines: an inline function of a library would be compiled for the widest one, and
# the linker may then keep that copy for everybody.
KERNEL_HEADERS = {"immintrin.h", "stdint.h", "stddef.h", "cstdint", "cstddef"}
KERNEL_FOLDERS = ("pipeline/frontend/kernels/", "pipeline/mapping/kernels/", "pipeline/backend/kernels/")

MACHINE_NAMES = re.compile(r"(?<![\w.])/(?:work|home|root|tmp/w[t]?)/")

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
ROOM = re.compile(r"^\s*room\(([^)]*)\)", re.MULTILINE)


class Room(NamedTuple):
    folder: str
    uses: frozenset  # itself and all rooms to its left


def read_rooms(cmake_text):
    """name -> Room from the room(NAME FOLDER USES … LINKS …) lines, arrows followed to their ends."""
    rooms = {}
    for match in ROOM.finditer(cmake_text):
        words = match.group(1).split()
        name, folder, rest = words[0], words[1], words[2:]
        uses = {name}
        keyword = None
        for word in rest:
            if word in ("USES", "LINKS", "PRIVATE_LINKS"):
                keyword = word
            elif keyword == "USES":
                if word not in rooms:
                    raise ValueError(f"room {name} uses {word}, which is not a room above it")
                uses |= rooms[word].uses
        rooms[name] = Room(folder, frozenset(uses))
    if not rooms:
        raise ValueError("CMakeLists.txt has no room() line")
    return rooms


def room_of(path, rooms):
    """Name of the room a file lies in; the pipeline's own room has no sub-folders. None: in no room."""
    best = None
    for name, room in rooms.items():
        inside = path.startswith(room.folder + "/")
        if name == "pipeline":
            inside = inside and "/" not in path[len(room.folder) + 1:]
        if inside and (best is None or len(room.folder) > len(rooms[best].folder)):
            best = name
    return best


def matches(path, patterns):
    return any(fnmatch(path, pattern) for pattern in patterns)


def without_comments(text):
    """The text with comments blanked and its lines kept."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group(0))
    return re.sub(r"//[^\n]*|/\*.*?\*/", blank, text, flags=re.DOTALL)


class Checker:
    def __init__(self, root):
        self.root = Path(root)
        self.rooms = read_rooms((self.root / "CMakeLists.txt").read_text())
        self.violations = []

    def complain(self, path, line, message):
        self.violations.append(f"{path}:{line}: {message}")

    def run(self):
        for folder in SOURCE_FOLDERS:
            for file in sorted((self.root / folder).rglob("*")):
                if file.suffix in SOURCE_SUFFIXES:
                    self.check_source(str(file.relative_to(self.root)), file.read_text())
        self.check_machine_names()
        return self.violations

    def check_source(self, path, text):
        room = room_of(path, self.rooms)
        if room is None and not path.startswith("tools/"):
            self.complain(path, 1, "lies in no room of CMakeLists.txt")
            return
        code = without_comments(text)
        for number, line in enumerate(code.splitlines(), 1):
            include = INCLUDE.match(line)
            if include and include.group(1) == '"':
                self.check_own(path, room, number, include.group(2))
            elif include:
                self.check_library(path, number, include.group(2))
            elif path.startswith("pipeline/") and CALLS_NOT_IN_PIPELINE.search(line):
                self.complain(path, number, "the pipeline has no threads, files or sockets of its own")

    def check_own(self, path, room, number, header):
        if not (self.root / header).is_file():
            self.complain(path, number, f'"{header}" is no file of this repository, named from its root')
            return
        if is_kernel(path) and os.path.dirname(header) != os.path.dirname(path):
            self.complain(path, number, f'"{header}": kernels include only {os.path.dirname(path)}/')
        target = room_of(header, self.rooms)
        if room is None:
            folder = next(program for program in PROGRAMS if path.startswith(program + "/"))
            if not (target in PROGRAMS[folder] or matches(header, PROGRAMS[folder])):
                self.complain(path, number, f'"{header}": {folder} may not include that')
        elif target not in self.rooms[room].uses:
            allowed = " ".join(sorted(self.rooms[room].uses))
            self.complain(path, number, f'"{header}": room {room} may enter {allowed}, not {target or "a program"}')

    def check_library(self, path, number, header):
        if path.startswith("pipeline/") and header in NOT_IN_PIPELINE:
            self.complain(path, number, f"<{header}>: the pipeline has no threads, files or sockets of its own")
        if is_kernel(path) and header not in KERNEL_HEADERS:
            self.complain(path, number, f"<{header}>: kernels include no library, their code is compiled several times")
        if matches(path, ANY_DOOR):
            return
        door = next((patterns for name, patterns in DOORS if fnmatch(header, name)), None)
        if door is None:
            if not is_system_header(header):
                self.complain(path, number, f"<{header}>: a library without a door; name one in .ci/check_rooms.py")
        elif not matches(path, door) or (header.startswith("Eigen/") and path.startswith("pipeline/base/")):
            self.complain(path, number, f"<{header}>: its door is {', '.join(door)}")

    def check_machine_names(self):
        for folder, folders, files in os.walk(self.root):
            if Path(folder) == self.root:
                folders[:] = [name for name in folders if name not in (".git", "out") and not name.startswith("build")]
            folders.sort()
            for file in sorted(Path(folder) / name for name in files):
                path = str(file.relative_to(self.root))
                if path != ".git" and "check_rooms" not in path:
                    self.check_text(path, file)

    def check_text(self, path, file):
        try:
            lines = file.read_text().splitlines()
        except UnicodeDecodeError:
            return  # images and recordings
        for number, line in enumerate(lines, 1):
            name = MACHINE_NAMES.search(line)
            if name:
                self.complain(path, number, f"{name.group(0)} is a folder of one machine")


def is_kernel(path):
    """Kernel sources, and the headers they share (a dispatcher is an ordinary source of the room)."""
    return path.startswith(KERNEL_FOLDERS) and (path.endswith(".kernel.cpp") or
                                               (path.endswith(".hpp") and not path.endswith("dispatch.hpp")))


def is_system_header(header):
    """C++ standard headers have no dot; C's and the operating system's end in .h and lie at the top, in sys/ or net*/."""
    if "." not in header:
        return "/" not in header
    return header.endswith(".h") and ("/" not in header or header.startswith(("sys/", "net/", "netinet/", "arpa/", "linux/")))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", nargs="?", default=Path(__file__).resolve().parent.parent, type=Path)
    violations = Checker(parser.parse_args().root).run()
    for violation in violations:
        print(violation)
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
