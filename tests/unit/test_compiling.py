"""A command that compiles says so once, and one that does not says nothing."""

from numba import njit

from asperity.cli.compiling import compile_visibly


def test_compiling_is_said_in_one_line(capsys):
    @njit
    def twice(value):
        return value + value

    def small():
        assert twice(2) == 4
        assert twice(2.0) == 4.0

    compile_visibly("planes", small)
    said = capsys.readouterr()
    assert said.err == "asperity: compiling, at the first use only, about 30 s\n"
    compile_visibly("planes", small)
    assert capsys.readouterr().err == ""


def test_what_the_small_calculation_refuses_is_left_to_the_command(capsys):
    def small():
        raise ValueError("refused")

    compile_visibly("contact", small)
    assert capsys.readouterr().err == ""
