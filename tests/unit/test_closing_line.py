from closing_line import closing_line


def test_a_run_without_failures_says_how_many_tests_passed_and_how_long_it_took() -> None:
    assert closing_line(2030, 0, [], 520.4) == "PackCell: all 2030 tests passed in 8 min 40 s"
    assert closing_line(1, 0, [], 0.6) == "PackCell: all 1 tests passed in 1 s"


def test_failures_are_counted_among_all_that_ran() -> None:
    line = closing_line(8, 2, [], 3.0)
    assert line == "PackCell: 2 of 10 tests failed in 3 s; they are listed above"


def test_reasons_for_skipping_are_given_once_each_and_in_short() -> None:
    line = closing_line(5, 0, ["no GPU", "needs root: use sudo", "no GPU"], 61.0)
    assert line.endswith("passed in 1 min 1 s; 3 skipped (needs root; no GPU)")


def test_a_run_that_was_stopped_is_not_called_complete() -> None:
    line = closing_line(7, 0, [], 3.0, is_cut_off=True)
    assert line == "PackCell: stopped before the end; the first 7 tests passed in 3 s"
