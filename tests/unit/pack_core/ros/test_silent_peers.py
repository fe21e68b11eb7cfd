"""Silent nodes."""

from pack_core.ros.silent_peers import SilentPeers


def test_a_silence_lasts_from_its_beginning_until_the_node_is_heard_of_again() -> None:
    silent = SilentPeers()
    assert not silent
    silent.note("sim", False, 10.0)
    silent.note("sim", False, 11.5)
    silent.note("mpc", False, 11.0)
    assert str(silent) == "mpc, sim"
    assert silent.lasting(1.0, 11.0) == []
    assert silent.lasting(1.0, 11.9) == ["sim"]
    silent.note("sim", True, 12.0)
    assert silent.lasting(1.0, 20.0) == ["mpc"]
    silent.note("mpc", True, 20.0)
    assert not silent
