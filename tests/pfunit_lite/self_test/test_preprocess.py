"""Tests of the substitute for pFUnit itself: what it rejects, what its programs print, and that
ctest sees through a program that stops early or runs no test.

Environment: PFUNIT_LITE_FC (the Fortran compiler), PFUNIT_LITE_CMAKE (cmake), both optional.
"""
import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

LITE = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(LITE))
import preprocess  # noqa: E402
FC = os.environ.get("PFUNIT_LITE_FC", "gfortran")
CMAKE = os.environ.get("PFUNIT_LITE_CMAKE", "cmake")
# The order of compilation
MODULES = ["lite_text", "lite_exceptions", "lite_basic", "lite_int32", "lite_int64",
           "lite_real32", "lite_real64", "lite_suite", "lite_runner", "funit"]
PASS = re.compile(r"OK[\r\n]+ \([1-9][0-9]* test")

GOOD = """module test_x
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use funit
   implicit none
contains
   @test
   subroutine check()
      real(8) :: nan, inf
      integer :: five
      nan = ieee_value(1d0, ieee_quiet_nan)
      inf = ieee_value(1d0, ieee_positive_inf)
      five = 5
      BODY
   end subroutine check
end module test_x
"""
BODY_LINE = 13


def run(*command, **keywords):
    return subprocess.run([str(word) for word in command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False, **keywords)


class Scratch(unittest.TestCase):
    """A directory that a test may write to"""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="pfunit_lite_")
        self.addCleanup(scratch.cleanup)
        self.directory = Path(scratch.name)

    def preprocess(self, text, name="test_x.pf"):
        """The status of preprocess.py and what it printed"""
        path = self.directory / name
        path.write_text(text, encoding="utf-8")
        output = path.with_suffix(".F90")
        if output.exists():
            output.unlink()
        with contextlib.redirect_stderr(io.StringIO()) as errors:
            status = preprocess.main([str(path), str(output)])
        return status, errors.getvalue()


class Rejections(Scratch):
    """Every construct outside the subset stops with file, line, cause and cure"""

    def assert_rejected(self, text, line, cause, name="test_x.pf"):
        status, errors = self.preprocess(text, name)
        self.assertEqual(status, 1, errors)
        self.assertFalse((self.directory / name).with_suffix(".F90").exists())
        self.assertRegex(errors, rf"{re.escape(name)}:{line}: error: .*{re.escape(cause)}.*; .+")

    def assert_body_rejected(self, body, cause):
        with self.subTest(body=body):
            self.assert_rejected(GOOD.replace("BODY", body), BODY_LINE, cause)

    def test_the_good_file_is_accepted(self):
        self.assertEqual(self.preprocess(GOOD.replace("BODY", "@assertEqual(5, five)")), (0, ""))
        text = (self.directory / "test_x.F90").read_text(encoding="utf-8")
        self.assertIn("call assertEqual(5, five, &", text)
        self.assertIn("location=SourceLocation('test_x.pf', 13))", text)
        self.assertIn("if (anyExceptions()) return", text)
        self.assertIn("function test_x_suite() result(suite)", text)

    def test_asserts_that_are_not_one_plain_line(self):
        for body, cause in [
                ("if (five == 5) @assertTrue(.true.)", "'@' inside a statement"),
                ("five = 4; @assertTrue(.true.)", "'@' inside a statement"),
                ("@assertEqual(5, five) ! five", "text after the closing parenthesis"),
                ("@assertEqual(5, five); five = 4", "text after the closing parenthesis"),
                ("@assertEqual(5, &\n five)", "does not end on its line"),
                ("@assertEqual(5, five) &", "text after the closing parenthesis"),
                ("@assertEqual (5, five)", "without '(' directly after it"),
                ("@assertEqual", "without '(' directly after it"),
                ("@assertEqual(5, five" + " + 0" * 30 + ")", "columns")]:
            self.assert_body_rejected(body, cause)
        self.assert_rejected(GOOD.replace("BODY", "five = 5 + &\n@assertTrue(.true.)"), 14,
                             "inside a continued statement")

    def test_asserts_with_other_names_or_arguments(self):
        for body, cause in [
                ("@assertequal(5, five)", "not in the subset"),
                ("@assertAll([.true.])", "not in the subset"),
                ("@mpiAssertEqual(5, five)", "not in the subset"),
                ("@assertEqual(5)", "1 positional"),
                ("@assertEqual(5, five, 'five')", "3 positional"),
                ("@assertEqual(1.0, 1.0, 0.1)", "3 positional"),
                ("@assertEqual(5, five, )", "empty argument"),
                ("@assertEqual(expected=5, actual=five)", "0 positional"),
                ("@assertEqual(5, five, message='a', 3)", "after a keyword"),
                ("@assertEqual(5, five, message='a', message='b')", "does not take"),
                ("@assertEqual(5, five, location=here)", "does not take"),
                ("@assertNotEqual(1.0, 2.0, tolerance=0.1)", "does not take"),
                ("@assertRelativelyEqual(1.0, 1.0)", "lacks tolerance="),
                ("@assertTrue(.true., 'text')", "2 positional"),
                ("@assertFail()", "has 0 arguments"),
                ("@assertFail('a', message='b')", "has 2 arguments")]:
            self.assert_body_rejected(body, cause)

    def test_marks_that_do_not_stand_before_a_plain_subroutine(self):
        for mark, line in [
                ("@test ! comment\n   subroutine check()", 6),
                ("@test(npes=[1, 2])\n   subroutine check()", 6),
                ("@test(cases=[1, 2])\n   subroutine check()", 6),
                ("@before()\n   subroutine check()", 6),
                ("@test\n\n   subroutine check()", 6),
                ("@test\n   ! comment\n   subroutine check()", 6),
                ("@test\n   subroutine check", 6),
                ("@test\n   subroutine check(this)", 6),
                ("@test\n   recursive subroutine check()", 6),
                ("@test\n   subroutine check() ! comment", 6),
                ("@test\n   integer function other()\n   end function\n   subroutine check()", 6),
                ("@test\n   @test\n   subroutine check()", 6),
                ("@disable\n   @test\n   subroutine check()", 6),
                ("@before\n   @disable\n   subroutine check()", 7),
                ("@test\n   @disable(1)\n   subroutine check()", 7),
                ("@Test\n   subroutine check()", 6),
                ("@testCase\n   subroutine check()", 6),
                ("@testParameter\n   subroutine check()", 6),
                ("@suite\n   subroutine check()", 6),
                ("subroutine outer()\n   contains\n   @test\n   subroutine check()", 8)]:
            with self.subTest(mark=mark):
                text = GOOD.replace("BODY", "").replace("@test\n   subroutine check()", mark)
                self.assert_rejected(text, line, "")
        second = "".join(f"@after\nsubroutine {name}()\nend subroutine\n" for name in ("a", "b"))
        self.assert_rejected(GOOD.replace("BODY", "").replace("   @test\n", second + "   @test\n"),
                             9, "a second @after")
        self.assert_rejected(GOOD.replace("BODY", "").replace("end module", "@test\nend module"),
                             15, "not directly before")

    def test_marks_outside_the_procedures(self):
        good = GOOD.replace("BODY", "")
        self.assert_rejected(good.replace("contains\n", "@test\ncontains\n"), 5, "'contains'")
        self.assert_rejected(good.replace("   @test\n", "@assertTrue(.true.)\n   @test\n"), 6,
                             "outside a procedure")

    def test_modules_of_another_form(self):
        good = GOOD.replace("BODY", "")
        end = "end module test_x\n"
        for text, line, cause in [
                (good.replace("module test_x\n", "module other\n", 1), 1, "begin with its module"),
                (good.replace("module test_x\n", "module test_x ! tests\n", 1), 1, "begin with"),
                ("", 1, "empty"),
                (good.replace(end, ""), 14, "does not end"),
                (good + "module second\nend module second\n", 16, "after the end"),
                (good.replace("implicit none", ""), 1, "implicit none"),
                (good.replace("use funit", ""), 1, "does not use funit"),
                (good.replace("use funit", "use funit, only: TestSuite"), 3, "in part"),
                (good.replace("use funit", "use funit\n   use model"), 4, "imports every name"),
                (good.replace("      BODY", "").replace("real(8) ::", "use model\nreal(8) ::"), 8,
                 "imports every name"),
                ("#include 'x'\n" + good, 1, "#include"),
                ("module test_x\nuse funit\nimplicit none\nend module test_x\n", 1, "'contains'")]:
            with self.subTest(cause=cause):
                self.assert_rejected(text, line, cause)
        self.assert_rejected(good, 1, "no name of a test file", name="x_tests.pf")

    def test_names_that_pfunit_uses_itself(self):
        good = GOOD.replace("BODY", "")
        for code, cause in [
                ("use model, only: a, &\n      run", "'run' is also a name"),
                ("use model, only: initialize => start", "'initialize' is also a name"),
                ("use model, only: suite", "public name 'suite'"),
                ("use funit\n   implicit none\n   real :: a(2, 3), T(2) = [1, 2]", "name 't'")]:
            with self.subTest(code=code):
                text = good.replace("use funit\n", code + "\n   use funit\n", 1)
                if "implicit" in code:
                    text = good.replace("use funit\n   implicit none", code)
                self.assertIn(cause, self.preprocess(text)[1])
        for code in ["real, private :: t", "real :: t\n   private :: t",
                     "private\n   real :: t\n   public :: check",
                     "type a\n   real :: t\n   end type a"]:
            with self.subTest(code=code):
                text = good.replace("implicit none", "implicit none\n   " + code)
                self.assertEqual(self.preprocess(text), (0, ""))
        self.assert_rejected(good.replace("implicit none", "implicit none\n   private"), 8,
                             "'check' is private")

    def test_at_signs_in_strings_and_comments_are_left_alone(self):
        body = "print *, 'a@b', \"@assert\" ! @test\n      print *, 'it''s &\n      & @c'"
        self.assertEqual(self.preprocess(GOOD.replace("BODY", body)), (0, ""))

    def test_every_error_of_a_file_is_reported(self):
        text = GOOD.replace("BODY", "@assertX(1)\n      @assertEqual(1)").replace("use funit", "")
        self.assertEqual(self.preprocess(text)[1].count(": error: "), 3)


class Programs(Scratch):
    """What compiled tests do"""

    @classmethod
    def setUpClass(cls):
        build = tempfile.TemporaryDirectory(prefix="pfunit_lite_")
        cls.addClassCleanup(build.cleanup)
        cls.build = Path(build.name)
        sources = [LITE / f"{module}.f90" for module in MODULES]
        result = run(FC, "-c", *sources, cwd=cls.build)
        assert result.returncode == 0, result.stdout

    def compile(self, text):
        self.assertEqual(self.preprocess(text), (0, ""))
        driver, program = self.directory / "driver.f90", self.directory / "program"
        preprocess.main(["--driver", str(driver), "test_x"])
        objects = [self.build / f"{module}.o" for module in MODULES]
        return program, run(FC, "-ffree-line-length-none", f"-I{self.build}", "-J", self.directory,
                            self.directory / "test_x.F90", driver, *objects, "-o", program)

    def run_body(self, body, *options):
        program, result = self.compile(GOOD.replace("BODY", body))
        self.assertEqual(result.returncode, 0, result.stdout)
        return run(program, *options)

    def test_a_failure_names_its_line_and_stops_with_2(self):
        result = self.run_body("@assertEqual(4, five, message='the member tri3')", "--verbose")
        self.assertEqual(result.returncode, 2)
        self.assertIn("FAILURES!!!", result.stdout)
        self.assertIn("*** Encountered 1 or more failures/errors during testing ***", result.stdout)
        self.assertIn("test_x.pf:13: the member tri3", result.stdout)
        self.assertIn("expected 4 but found 5", result.stdout)
        self.assertIsNone(PASS.search(result.stdout))

    def test_a_compiler_error_names_the_line_of_the_test_file(self):
        _, result = self.compile(GOOD.replace("BODY", "@assertTrue(5)\n      five = six"))
        self.assertRegex(result.stdout, r"test_x\.pf:14:")

    def test_assertions_that_must_fail(self):
        """All in one program: each in a helper, of which the exceptions are counted"""
        bodies = [
            "@assertEqual(1d0, 1d0 + 1d-12)", "@assertEqual(1.0, 1.5, tolerance=0.4)",
            "@assertEqual(1d0, 1.5d0, tolerance=0.4)", "@assertEqual(1d0, 1.5d0, tolerance=0.4d0)",
            "@assertEqual(nan, nan)", "@assertEqual(nan, 1d0, tolerance=1d9)",
            "@assertEqual(1d0, nan, tolerance=inf)", "@assertEqual(inf, -inf, tolerance=1d9)",
            "@assertEqual(1d0, inf, tolerance=1d9)", "@assertEqual([1, 2], [1, 2, 3])",
            "@assertEqual(1d0, [1d0, 2d0])", "@assertEqual([1d0, nan], [1d0, nan])",
            "@assertEqual(0, reshape([0, 0, 0, 1], [2, 2]))",
            "@assertRelativelyEqual(1d0, 1.2d0, tolerance=0.1d0)",
            "@assertRelativelyEqual(0d0, 0d0, tolerance=0.1)",
            "@assertRelativelyEqual(inf, 1d0, tolerance=0.1)",
            "@assertRelativelyEqual(nan, nan, tolerance=0.1)",
            "@assertLessThan(1, 1)", "@assertLessThan(nan, 1d0)", "@assertLessThan(1d0, nan)",
            "@assertLessThanOrEqual(nan, nan)", "@assertGreaterThan(1.0, 1.0)",
            "@assertGreaterThanOrEqual([1, 2], [1, 3])", "@assertNotEqual(1d0, 1d0)",
            "@assertTrue(five == 4)", "@assertFalse(five == 5)", "@assertEqual(.true., .false.)",
            "@assertEqual('a', 'b')", "@assertEqual('a', ' a')",
            "@assertEqual('a', 'a ', whitespace=KEEP_ALL)",
            "@assertIsNaN(inf)", "@assertIsFinite(inf)", "@assertIsFinite(nan)",
            "@assertFail('always')", "@assertExceptionRaised()", "@assertSameShape([2], [2, 1])"]
        test = GOOD[GOOD.index("   @test"):GOOD.index("end module")]
        tests = "".join(test.replace("BODY", body).replace("check", f"check_{i}")
                        for i, body in enumerate(bodies))
        program, result = self.compile(GOOD.replace(test, tests))
        self.assertEqual(result.returncode, 0, result.stdout)
        output = run(program, "--verbose").stdout
        passed = [bodies[int(i)] for i in re.findall(r"passed .*\.check_(\d+)", output)]
        self.assertEqual(passed, [])
        self.assertIn(f"Tests run: {len(bodies)}, failures: {len(bodies)}", output)
        self.assertIn("in element (2)", output)
        self.assertIn("in element (2,2)", output)

    def test_a_stop_in_the_tested_code_does_not_match_the_pass_expression(self):
        self.assertIsNone(PASS.search(self.run_body("stop", "--verbose").stdout))

    def test_no_test_does_not_match_the_pass_expression(self):
        program, _ = self.compile(GOOD.replace("   @test\n", "").replace("BODY", ""))
        result = run(program, "--verbose")
        self.assertIn(" OK\n (0 tests)", result.stdout)
        self.assertIsNone(PASS.search(result.stdout))

    def test_filter_picks_tests_by_a_part_of_their_name(self):
        text = GOOD.replace("BODY", "@assertEqual(5, five)").replace(
            "end module",
            "@test\nsubroutine broken()\n@assertFail('x')\nend subroutine\nend module")
        program, _ = self.compile(text)
        result = run(program, "--verbose", "--filter", "check")
        self.assertEqual(result.returncode, 0)
        self.assertTrue(result.stdout.endswith(" OK\n (1 test)\n"), result.stdout)
        self.assertEqual(run(program, "--filter", "broken").returncode, 2)
        self.assertIn("(0 tests)", run(program, "--filter", "nothing").stdout)
        self.assertEqual(run(program, "--unknown").returncode, 2)
        self.assertEqual(run(program, "--filter").returncode, 2)

    def test_tear_down_runs_after_a_failure_and_the_test_not_after_a_failed_set_up(self):
        before = "@before\nsubroutine prepare()\n@assertFail('set-up')\nend subroutine\n"
        after = "@after\nsubroutine clean()\nprint *, 'cleaned'\nend subroutine\n"
        text = GOOD.replace("BODY", "print *, 'ran'").replace("contains\n", "contains\n" + after)
        program, _ = self.compile(text.replace("contains\n", "contains\n" + before))
        output = run(program).stdout
        self.assertIn("cleaned", output)
        self.assertNotIn("ran\n", output)


class Ctest(Scratch):
    """The CMake function from end to end"""

    def test_ctest_passes_the_good_and_catches_failing_stopping_and_empty_programs(self):
        good = "five = 5\n      @assertEqual(5, five)"
        for name, text in [("good", GOOD.replace("BODY", good)),
                           ("failing", GOOD.replace("BODY", "@assertFail('x')")),
                           ("stopping", GOOD.replace("BODY", "stop")),
                           ("empty", GOOD.replace("   @test\n", "").replace("BODY", ""))]:
            (self.directory / f"test_{name}.pf").write_text(
                text.replace("test_x", f"test_{name}"), encoding="utf-8")
        (self.directory / "CMakeLists.txt").write_text(f"""
cmake_minimum_required(VERSION 3.22)
project(scratch LANGUAGES Fortran)
enable_testing()
set(PFUNIT_LITE ON)
include("{LITE.parent.as_posix()}/pfunit.cmake")
foreach(name good failing stopping empty)
  add_pfunit_ctest(${{name}} TEST_SOURCES test_${{name}}.pf LABELS unit)
endforeach()
""", encoding="utf-8")
        build = self.directory / "build"
        for command in [("-S", self.directory, "-B", build, f"-DCMAKE_Fortran_COMPILER={FC}"),
                        ("--build", build, "--parallel")]:
            result = run(CMAKE, *command)
            self.assertEqual(result.returncode, 0, result.stdout)
        ctest = Path(CMAKE).with_name("ctest") if os.sep in CMAKE else "ctest"
        output = run(ctest, "-L", "unit", cwd=build).stdout
        self.assertRegex(output, r" good \.+ +Passed")
        for name in ("failing", "stopping", "empty"):
            self.assertRegex(output, rf" {name} \.+\**Failed +Required regular expression not")


if __name__ == "__main__":
    unittest.main()
