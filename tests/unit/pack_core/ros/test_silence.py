"""Silent nodes."""

from pack_core.ros.silence import Silence


def test_a_silence_lasts_from_its_beginning_until_the_node_is_heard_of_again() -> None:
    silence = Silence()
    assert not silence
    silence.note("sim", False, 10.0)
    silence.note("sim", False, 11.5)
    silence.note("mpc", False, 11.0)
    assert str(silence) == "mpc, sim"
    assert silence.lasting(1.0, 11.0) == []
    assert silence.lasting(1.0, 11.9) == ["sim"]
    silence.note("sim", True, 12.0)
    assert silence.lasting(1.0, 20.0) == ["mpc"]
    silence.note("mpc", True, 20.0)
    assert not silence
