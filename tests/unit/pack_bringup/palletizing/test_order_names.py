"""What the orders made of lists are called: no list is lost because another has the same name."""

from pathlib import Path

import pytest

from pack_bringup.palletizing.order_command import order_names
from pack_core.errors import OrderError


def test_an_order_has_the_name_of_its_list_or_that_given() -> None:
    assert order_names([Path("a/tea.csv"), Path("cups 2.json")]) == {
        "tea": Path("a/tea.csv"),
        "cups 2": Path("cups 2.json"),
    }
    assert order_names([Path("a/tea.csv")], "monday") == {"monday": Path("a/tea.csv")}


def test_two_lists_of_one_name_are_refused_with_both() -> None:
    with pytest.raises(OrderError, match=r"monday/items.csv and tuesday/items.csv would both become the"):
        order_names([Path("monday/items.csv"), Path("tuesday/items.csv")])


def test_so_is_a_list_with_the_name_of_anothers_second_pallet() -> None:
    with pytest.raises(OrderError, match=r"items-2.csv would become .*a further pallet of items.csv"):
        order_names([Path("items-2.csv"), Path("items.csv")])
    assert order_names([Path("items-2.csv"), Path("items-b.csv")])


@pytest.mark.parametrize("name", ["Ben's list & co", "a" * 65, "-1", "a/b", ""])
def test_a_name_that_no_order_may_have_is_refused_before_the_work(name: str) -> None:
    with pytest.raises(OrderError, match=r"allowed: a letter or digit first.*--name"):
        order_names([Path("Ben's list & co.csv")], name)
