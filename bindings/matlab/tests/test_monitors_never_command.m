function test_monitors_never_command()
% An object that has not driven sends no command, not even a zero, however its methods end: it would
% take the robot from the program that drives it.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
monitor = sim.connect();
monitor.sleep(0.1);
monitor.record(0.1);
monitor.driveFor(0.3, 0, 0);
check_raises('roburoc4:badArgument', @() monitor.sleep('a'));
check_raises('roburoc4:badArgument', @() monitor.record(0.1, 'localisation'));
check_raises('roburoc4:badArgument', @() monitor.driveFor(NaN, 0, 1));
check_raises('roburoc4:notArmed', @() monitor.driveFor(0.3, 0, 1));
left_early(sim, monitor);
check(sim.state.speed_commands == 0, 'a monitor sent %d commands', sim.state.speed_commands);

% The drive of another object continues, and the one that drove sends zeros.
driver = sim.connect('lease_ms', 1000);
driver.arm();
driver.drive(0.5, 0);
check_raises('roburoc4:badArgument', @() monitor.record(0.1, 'localisation'));
left_early(sim, monitor);
delete(monitor);
check(sim.state.target_linear_m_s == 0.5, 'a monitor stopped the robot of another');
left_early(sim, driver);
check(sim.state.target_linear_m_s == 0, 'who drove did not stop');
delete(driver);
delete(sim);
end

function left_early(sim, robot)
% What is left of a method that waits after Ctrl-C in it.
cleanup = roburoc4.internal.guard(robot.id);
sim.step(0.05);
clear cleanup
sim.step(0.05);
end
