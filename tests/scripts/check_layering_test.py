# SPDX-License-Identifier: Apache-2.0
"""Tests of scripts/check_layering.py on small trees with known faults."""

import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import check_layering  # noqa: E402

TABLE = """
group low = daemon/common/base eigen
daemon/common/base  :
daemon/track : low
daemon/rim   : low daemon/track yaml files clock
"""


class CheckLayering(unittest.TestCase):
    def faults(self, files, table=TABLE):
        with tempfile.TemporaryDirectory() as root:
            for path, text in files.items():
                os.makedirs(os.path.join(root, os.path.dirname(path)), exist_ok=True)
                with open(os.path.join(root, path), "w", encoding="utf-8") as file:
                    file.write(text)
            return check_layering.check(root, check_layering.read_table(table))

    def test_a_listed_arrow_passes(self):
        self.assertEqual([], self.faults({
            "daemon/common/base/a.h": "#include <vector>\n",
            "daemon/track/t.cc": '#include "daemon/common/base/a.h"\n#include <Eigen/Core>\n',
        }))

    def test_an_unlisted_arrow_is_a_fault_with_file_and_line(self):
        faults = self.faults({
            "daemon/track/t.h": "",
            "daemon/common/base/a.h": '// why\n#include "daemon/track/t.h"\n',
        })
        self.assertEqual(
            ["daemon/common/base/a.h:2: daemon/common/base may not include daemon/track (daemon/track/t.h)"],
            faults)

    def test_a_library_outside_its_room_is_a_fault(self):
        faults = self.faults({"daemon/track/t.cc": "#include <yaml-cpp/yaml.h>\n"})
        self.assertEqual(1, len(faults))
        self.assertIn("may not use yaml", faults[0])

    def test_abilities_are_checked_like_libraries(self):
        files = {"daemon/track/t.cc": "#include <mutex>\n#include <sys/stat.h>\n#include <fstream>\n"}
        self.assertEqual(3, len(self.faults(files)))

    def test_a_clock_read_in_a_pure_room_is_a_fault_but_not_in_a_comment(self):
        read = "auto t = std::chrono::steady_clock::now();\n"
        self.assertEqual(1, len(self.faults({"daemon/track/t.cc": read})))
        self.assertEqual([], self.faults({"daemon/rim/r.cc": read}))
        self.assertEqual([], self.faults({"daemon/track/t.cc": "// " + read}))

    def test_commented_includes_do_not_count(self):
        self.assertEqual([], self.faults(
            {"daemon/common/base/a.h": '/*\n#include "daemon/track/t.h"\n*/\n'}))

    def test_missing_headers_foreign_paths_and_unknown_libraries_are_faults(self):
        faults = self.faults({"daemon/track/t.cc":
                              '#include "daemon/common/base/gone.h"\n#include "t.h"\n#include <odd/x.h>\n'})
        self.assertEqual(3, len(faults))

    def test_a_folder_that_is_no_room_is_a_fault(self):
        self.assertIn("not a room", self.faults({"daemon/utils/u.h": ""})[0])

    def test_a_test_that_mirrors_no_room_is_a_fault(self):
        self.assertIn("mirrors no room", self.faults({"tests/daemon/gone/g_test.cc": ""})[0])
        self.assertEqual([], self.faults({"tests/daemon/track/t_test.cc": "#include <any/x.h>\n"}))

    def test_a_table_with_a_circle_an_unknown_word_or_a_lost_room_is_refused(self):
        for table in ("daemon/a : daemon/b\ndaemon/b : daemon/a\n", "daemon/a : eigne\n",
                      "daemon/a : daemon/gone\n", "daemon/a :\ndaemon/a :\n"):
            with self.assertRaises(check_layering.TableError, msg=table):
                check_layering.read_table(table)

    def test_a_wall_keeps_what_is_behind_it_apart(self):
        rooms = "daemon/local/track : daemon/common/base\ndaemon/common/base :\ndaemon/v2v/trust :\n"
        wall = "wall daemon/local : daemon/common\n"
        check_layering.read_table(wall + rooms)
        through = rooms.replace("daemon/common/base\n", "daemon/common/base daemon/v2v/trust\n", 1)
        with self.assertRaisesRegex(check_layering.TableError, "daemon/local/track reaches daemon/v2v"):
            check_layering.read_table(wall + through)
        with self.assertRaisesRegex(check_layering.TableError, "no such folder"):
            check_layering.read_table("wall daemon/nowhere : daemon/common\n" + rooms)

    def test_top_level_folders_form_no_circle(self):
        with self.assertRaisesRegex(check_layering.TableError, "circle"):
            check_layering.read_table("daemon/a : sim/b\nsim/b :\nsim/c : daemon/d\ndaemon/d :\n")


if __name__ == "__main__":
    unittest.main()
