from drake_twin.errors import InputError, RunError


def test_an_error_reads_file_line_message_suggestion_and_choices():
    error = InputError("there is no joint 'elbw'", file="a.yaml", line=3, value="elbw", valid=["wrist", "elbow"])
    assert str(error) == "a.yaml:3: there is no joint 'elbw'. Did you mean 'elbow'? Valid: wrist, elbow."


def test_parts_that_are_not_known_are_left_out():
    assert str(InputError("it is wrong.")) == "it is wrong."
    assert str(InputError("it is wrong", file="a.yaml")) == "a.yaml: it is wrong."


def test_a_file_whose_name_has_two_lines_is_said_in_one():
    assert str(InputError("it is wrong", file="a\nb.yaml")) == "a b.yaml: it is wrong."


def test_input_errors_and_failures_while_running_end_with_different_exit_codes():
    assert (InputError("").exit_code, RunError("").exit_code) == (2, 1)
