import os
import socket
from collections.abc import Iterator

import pytest

from pack_bringup.graph import running
from pack_bringup.graph.running import DOMAINS, choose_domain, is_free
from pack_core.errors import PackError

FIRST = 1 + os.getpid() % DOMAINS


@pytest.fixture
def busy() -> Iterator[int]:
    """A domain with a participant."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as participant:
        for domain in range(1, DOMAINS + 1):
            try:
                participant.bind(("", 7410 + 250 * domain))
            except OSError:
                continue
            yield domain
            return


def test_a_domain_with_a_participant_is_not_free(busy: int) -> None:
    assert not is_free(busy)


def test_the_environment_decides(busy: int) -> None:
    assert choose_domain({"ROS_DOMAIN_ID": str(busy)}) == busy


def test_busy_domains_are_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    free = 1 + (FIRST + 1) % DOMAINS
    monkeypatch.setattr(running, "is_free", lambda domain: domain == free)
    assert choose_domain({}) == free


def test_when_all_domains_are_busy_the_error_says_what_to_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "is_free", lambda _: False)
    with pytest.raises(PackError, match="set ROS_DOMAIN_ID"):
        choose_domain({})
