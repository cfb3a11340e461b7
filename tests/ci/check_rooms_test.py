"""Plants violations into a small house and looks whether check_rooms.py names each with its file and line."""
import importlib.util
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / ".ci" / "check_rooms.py"
spec = importlib.util.spec_from_file_location("check_rooms", SCRIPT)
check_rooms = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check_rooms)

FLOOR_PLAN = """
#    name      folder             uses
room(base      pipeline/base      USES                 LINKS Boost::headers)
room(geometry  pipeline/geometry  USES base            LINKS Eigen3::Eigen)
room(frontend  pipeline/frontend  USES geometry)
room(backend   pipeline/backend   USES frontend)
room(pipeline  pipeline           USES backend)
room(drivers   drivers            USES geometry)
room(daemon    daemon             USES pipeline drivers)
"""


class Rooms(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("CMakeLists.txt", FLOOR_PLAN)
        for header in ("pipeline/base/time.hpp", "pipeline/geometry/rigid.hpp", "pipeline/frontend/orb.hpp",
                       "pipeline/pipeline.hpp", "drivers/driver.hpp", "daemon/app.hpp", "daemon/publisher.hpp"):
            self.write(header, "#pragma once\n")

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def violations(self):
        return check_rooms.Checker(self.root).run()

    def assert_one(self, start, *words):
        found = self.violations()
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(start + ": "), found[0])
        for word in words:
            self.assertIn(word, found[0])

    def test_a_house_in_order_is_silent(self):
        self.write("pipeline/frontend/track.cpp", '#include <Eigen/Core>\n#include <vector>\n'
                   '#include "pipeline/base/time.hpp"\n#include "pipeline/geometry/rigid.hpp"\n')
        self.write("daemon/main.cpp", '#include <CLI/CLI.hpp>\n#include <thread>\n#include <sys/mman.h>\n'
                   '#include "drivers/driver.hpp"\n#include "pipeline/pipeline.hpp"\n')
        self.write("tools/povslam/replay.cpp", '#include "daemon/app.hpp"\n#include <nlohmann/json.hpp>\n')
        self.write("tools/bench/any_bench.cpp", '#include "pipeline/frontend/orb.hpp"\n#include <benchmark/benchmark.h>\n')
        self.assertEqual(self.violations(), [])

    def test_an_arrow_against_the_stream_is_named(self):
        self.write("pipeline/geometry/align.cpp", '#include <span>\n\n#include "pipeline/frontend/orb.hpp"\n')
        self.assert_one("pipeline/geometry/align.cpp:3", "pipeline/frontend/orb.hpp", "room geometry")

    def test_a_room_not_used_is_closed_even_if_it_lies_lower(self):
        self.write("drivers/replay/device.cpp", '#include "pipeline/frontend/orb.hpp"\n')
        self.assert_one("drivers/replay/device.cpp:1", "room drivers")

    def test_arrows_are_followed_through_rooms_between(self):
        self.write("daemon/app.cpp", '#include "pipeline/base/time.hpp"\n')
        self.assertEqual(self.violations(), [])

    def test_the_pipelines_own_room_has_no_unknown_folders(self):
        self.write("pipeline/attic/old.cpp", "\n")
        self.assert_one("pipeline/attic/old.cpp:1", "no room")

    def test_tools_may_not_reach_into_the_daemon(self):
        self.write("tools/povslam/listen.cpp", '#include "daemon/publisher.hpp"\n')
        self.assert_one("tools/povslam/listen.cpp:1", "tools/povslam")

    def test_an_include_names_a_file_from_the_root(self):
        self.write("pipeline/geometry/align.cpp", '#include "rigid.hpp"\n')
        self.assert_one("pipeline/geometry/align.cpp:1", "rigid.hpp", "root")

    def test_libraries_enter_through_their_doors_only(self):
        for path, header in (("pipeline/frontend/track.cpp", "ceres/ceres.h"), ("drivers/driver.cpp", "lcm/lcm-cpp.hpp"),
                             ("daemon/app.cpp", "toml++/toml.h"), ("daemon/app.cpp", "systemd/sd-daemon.h"),
                             ("daemon/app.cpp", "sqlite3.h"), ("pipeline/geometry/a.cpp", "spdlog/spdlog.h"),
                             ("pipeline/geometry/a.cpp", "opencv2/core.hpp"), ("pipeline/base/a.cpp", "Eigen/Core")):
            with self.subTest(header=header):
                self.write(path, f"\n#include <{header}>\n")
                self.assert_one(f"{path}:2", header, "door")
                (self.root / path).unlink()

    def test_an_unknown_library_needs_a_door(self):
        self.write("daemon/app.cpp", "#include <zmq/zmq.hpp>\n")
        self.assert_one("daemon/app.cpp:1", "without a door")

    def test_the_pipeline_has_no_threads_or_files(self):
        for line in ("#include <thread>", "#include <mutex>", "#include <fstream>", "#include <iostream>",
                     'auto* file = fopen("a", "r");', "std::jthread worker([] {});"):
            with self.subTest(line=line):
                self.write("pipeline/frontend/track.cpp", line + "\n")
                self.assert_one("pipeline/frontend/track.cpp:1", "no threads")

    def test_comments_are_not_code(self):
        self.write("pipeline/frontend/track.cpp", '// #include <thread>\n/*\n#include <mutex>\n fopen("a") */\n')
        self.assertEqual(self.violations(), [])

    def test_kernels_include_no_library_and_no_other_room(self):
        self.write("CMakeLists.txt", FLOOR_PLAN + "room(mapping pipeline/mapping USES geometry)\n"
                                                  "room(backend pipeline/backend USES mapping)\n")
        for folder in check_rooms.KERNEL_FOLDERS:
            self.write(folder + "dispatch.hpp", "#include <string>\n")
            for header in ("<vector>", "<algorithm>", "<Eigen/Core>", '"pipeline/base/time.hpp"'):
                for name in ("fast.kernel.cpp", "simd.hpp"):
                    with self.subTest(folder=folder, header=header, name=name):
                        self.write(folder + name, f"#include <immintrin.h>\n#include {header}\n")
                        self.assert_one(f"{folder}{name}:2", "kernels")
                        (self.root / folder / name).unlink()

    def test_folders_of_one_machine_are_named(self):
        self.write("docs/results.md", "fine\nrun it in /home/someone/povslam\n")
        self.assert_one("docs/results.md:2", "/home/")
        self.write("docs/results.md", "see https://example.org/work/ and ../shared/home/x\n")
        self.assertEqual(self.violations(), [])

    def test_a_floor_plan_out_of_order_is_an_error(self):
        with self.assertRaisesRegex(ValueError, "not a room above"):
            check_rooms.read_rooms("room(a x USES b)\nroom(b y USES)\n")


if __name__ == "__main__":
    unittest.main()
