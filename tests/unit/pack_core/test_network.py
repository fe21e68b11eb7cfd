"""Which environment variables decide who can reach a node: one of ours, and none of the middleware's."""

import re
import socket
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix

from pack_core.errors import ConfigError
from pack_core.network import (
    DISCOVERY_VARIABLE,
    DOMAIN_VARIABLE,
    PROFILE_VARIABLE,
    RULES,
    bound_addresses,
    check_bound,
    domain_in,
    enforce,
)
from pack_core.paths import project_root

PROFILE = """<dds xmlns="http://www.eprosima.com"><profiles>
<transport_descriptors><transport_descriptor><transport_id>udp</transport_id><type>{transport}</type>
<interfaceWhiteList>{addresses}</interfaceWhiteList></transport_descriptor></transport_descriptors>
</profiles></dds>"""
ANY = "192.0.2.9"
FORCED = {
    DISCOVERY_VARIABLE: ("LOCALHOST", "SYSTEM_DEFAULT", "SYSTEM_DEFAULT"),
    "ROS_LOCALHOST_ONLY": ("1", "", ""),
    "ROS_STATIC_PEERS": (ANY, "", ANY),
    "ROS_DISCOVERY_SERVER": (f"{ANY}:11811", "", ""),
    "ROS_SUPER_CLIENT": ("TRUE", "", ""),
    "FASTDDS_BUILTIN_TRANSPORTS": ("DEFAULT", "", ""),
    "FASTDDS_ENVIRONMENT_FILE": ("environment.json", "", ""),
    "FASTDDS_DEFAULT_PROFILES_FILE": ("open.xml", "", ""),
    "SKIP_DEFAULT_XML_FILE": ("0", "1", "1"),
    "SKIP_DEFAULT_XML": ("0", "1", "1"),
    "RMW_FASTRTPS_USE_QOS_FROM_XML": ("1", "", ""),
    "RMW_FASTRTPS_PUBLICATION_MODE": ("ASYNCHRONOUS", "", ""),
}
"""A value that somebody's shell may have, the one in force in a closed cell, and in one that is open."""
REFUSED = {
    PROFILE_VARIABLE: ["", "/nowhere/profile.xml", __file__, "/"],
    DOMAIN_VARIABLE: ["abc", "1.5", "-1", "102", "300", "٣"],
    "RMW_IMPLEMENTATION": ["rmw_cyclonedds_cpp", "rmw_zenoh_cpp"],
}
"""Values with which no node starts."""
WITHOUT_EFFECT = {
    "FASTDDS_STATISTICS": "topics about the middleware's own work",
    "ROS_DISABLE_LOANED_MESSAGES": "memory within a process, as none is shared",
    "ROS_SECURITY_ENABLE": "keys close a cell further",
    "ROS_SECURITY_ENCLAVE_OVERRIDE": "as above",
    "ROS_SECURITY_KEYSTORE": "as above",
    "ROS_SECURITY_STRATEGY": "as above",
    "ROS_HOME": "logs",
    "ROS_LOG_DIR": "logs",
}
"""Variables of the middleware that do not decide who can reach a node, with what they are about."""


@pytest.fixture
def closed(tmp_path: Path) -> dict[str, str]:
    """The environment of a closed cell."""
    return {PROFILE_VARIABLE: str(profile(tmp_path))}


def profile(folder: Path, *addresses: str, transport: str = "UDPv4") -> Path:
    listed = "".join(f"<address>{address}</address>" for address in ("127.0.0.1", *addresses))
    (folder / "profile.xml").write_text(PROFILE.format(transport=transport, addresses=listed))
    return folder / "profile.xml"


def test_every_rule_is_tested_here() -> None:
    assert FORCED.keys() | REFUSED.keys() == RULES.keys()


@pytest.mark.parametrize("name", FORCED)
def test_a_variable_of_the_middleware_is_overruled_by_name(name: str, closed: dict[str, str]) -> None:
    given, in_closed, _ = FORCED[name]
    closed[name] = given
    (said,) = enforce(closed)
    assert closed.get(name, "") == in_closed
    assert said.startswith(f"{name}={given} is not obeyed: ")
    assert enforce(closed) == []  # what inherits this environment has nothing to add


@pytest.mark.parametrize("name", FORCED)
def test_in_an_open_cell_too_but_for_what_it_needs(name: str, tmp_path: Path) -> None:
    given, _, in_open = FORCED[name]
    environment = {PROFILE_VARIABLE: str(profile(tmp_path, ANY)), name: given}
    said = enforce(environment)
    assert environment.get(name, "") == in_open
    assert bool(said) == (given != in_open)


@pytest.mark.parametrize(
    ("name", "value"), [(name, value) for name, all_ in REFUSED.items() for value in all_]
)
def test_a_value_with_which_no_node_can_start_is_refused_by_name(
    name: str, value: str, closed: dict[str, str]
) -> None:
    closed[name] = value
    with pytest.raises(ConfigError, match=name) as refused:
        enforce(closed)
    assert value in str(refused.value)


def test_the_refusal_of_a_middleware_says_what_is_installed(closed: dict[str, str]) -> None:
    closed["RMW_IMPLEMENTATION"] = "rmw_cyclonedds_cpp"
    with pytest.raises(ConfigError, match=r"installed: .*rmw_fastrtps_cpp"):
        enforce(closed)


def test_a_domain_is_a_number_whose_ports_are_free() -> None:
    allowed = {"": None, " ": None, "0": 0, " 7": 7, "101": 101}
    assert {text: domain_in({DOMAIN_VARIABLE: text}) for text in allowed} == allowed
    with pytest.raises(ConfigError, match=r"ROS_DOMAIN_ID is '1\.5'; allowed: 0 to 101"):
        domain_in({DOMAIN_VARIABLE: "1.5"})


def test_an_environment_in_order_stays_as_it_is(closed: dict[str, str]) -> None:
    closed |= {"RMW_IMPLEMENTATION": "rmw_fastrtps_cpp", DISCOVERY_VARIABLE: "SYSTEM_DEFAULT"}
    before = dict(closed)
    assert enforce(closed) == []
    assert closed == before | {"SKIP_DEFAULT_XML_FILE": "1", "SKIP_DEFAULT_XML": "1"}


@pytest.mark.parametrize("transport", ["SHM", "TCPv4", "UDPv6"])
def test_a_profile_with_another_transport_is_refused(transport: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=f"a transport {transport}; allowed: UDPv4"):
        enforce({PROFILE_VARIABLE: str(profile(tmp_path, transport=transport))})


def test_a_profile_without_an_allow_list_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "profile.xml"
    path.write_text('<dds xmlns="http://www.eprosima.com"/>')
    with pytest.raises(ConfigError, match="no interfaceWhiteList names an address"):
        enforce({PROFILE_VARIABLE: str(path)})


def test_every_variable_that_the_installed_middleware_reads_has_a_rule_or_no_effect() -> None:
    found = set()
    for package in ("rcl", "rmw_fastrtps_shared_cpp", "rmw_fastrtps_cpp", "fastrtps"):
        for library in Path(get_package_prefix("rmw_fastrtps_cpp"), "lib").glob(f"lib{package}.so*"):
            texts = re.findall(
                rb"\0((?:ROS|FASTRTPS|FASTDDS|SKIP|RMW_FASTRTPS)_[A-Z_]{4,})\0", library.read_bytes()
            )
            found |= {text.decode() for text in texts}
    assert {"ROS_LOCALHOST_ONLY", "FASTDDS_BUILTIN_TRANSPORTS"} <= found  # the libraries were read
    known = (*RULES, *WITHOUT_EFFECT)
    # A compiler may keep the end of a text elsewhere.
    assert {name for name in found if not any(other.startswith(name) for other in known)} == set()


def test_sockets_that_are_bound_wider_than_allowed_are_named(
    closed: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(PROFILE_VARIABLE, closed[PROFILE_VARIABLE])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        ours.bind(("0.0.0.0", 0))
        assert "0.0.0.0" in bound_addresses()
        with pytest.raises(ConfigError, match=rf"listens on .*0\.0\.0\.0.*{PROFILE_VARIABLE}"):
            check_bound()


def test_sockets_of_ipv6_are_seen_too() -> None:
    if not socket.has_ipv6:
        pytest.skip("no IPv6 here")
    with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as ours:
        try:
            ours.bind(("::1", 0))
        except OSError:
            pytest.skip("no IPv6 here")
        assert "::1" in bound_addresses()


def test_a_network_is_not_called_open_that_is_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(PROFILE_VARIABLE, str(profile(tmp_path, ANY)))
    with pytest.raises(ConfigError, match=f"the network is not open: .*allows {ANY}"):
        check_bound()


def test_nothing_joins_a_graph_but_in_an_environment_in_order() -> None:
    """All of ours start ROS by `start_ros`, which enforces the rules."""
    sources = project_root() / "ros_ws" / "src"
    starts = [path for path in sources.rglob("*.py") if "rclpy.init(" in path.read_text()]
    assert [path.relative_to(sources).as_posix() for path in starts] == ["pack_core/pack_core/ros/run.py"]
