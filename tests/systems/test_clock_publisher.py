from drake_twin.systems.clock_publisher import ClockPublisher


def test_the_clock_shows_simulation_time_to_the_nanosecond():
    dut = ClockPublisher()
    context = dut.CreateDefaultContext()
    context.SetTime(12.000000345)
    clock = dut.get_clock_output_port().Eval(context).clock
    assert (clock.sec, clock.nanosec) == (12, 345)


def test_a_time_that_floating_point_put_just_below_a_second_is_that_second():
    dut = ClockPublisher()
    context = dut.CreateDefaultContext()
    context.SetTime(0.1 + 0.2 + 0.7 - 1e-16)  # 0.9999999999999999
    clock = dut.get_clock_output_port().Eval(context).clock
    assert (clock.sec, clock.nanosec) == (1, 0)
