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

if exist('OCTAVE_VERSION', 'builtin')
    ctrl_c('r.sleep(60)');
    ctrl_c('r.record(60)');
    ctrl_c('l = r.rate(1); while true, l.wait(); end');
end
end

function left_early(sim, robot)
% What is left of a method that waits after Ctrl-C in it.
cleanup = roburoc4.internal.guard(robot.id);
sim.step(0.05);
clear cleanup
sim.step(0.05);
end

function ctrl_c(code)
sim = roburoc4.Simulator('port', 0);
begun = [tempname() '.begun'];
ended = [tempname() '.ended'];
pid = child(sim.address, '''lease_ms'', 1000', sprintf(['unwind_protect, ' ...
    'fclose(fopen(''%s'', ''w'')); %s; unwind_protect_cleanup, fclose(fopen(''%s'', ''w'')); ' ...
    'pause(5); end_unwind_protect'], begun, code, ended));
cleanup = onCleanup(@() kill(pid, 9));
wait_for(begun);
pause(0.5);
numbers = SIG();
kill(pid, numbers.INT);
wait_for(ended);
pause(0.3);
check(sim.state.speed_commands == 0, 'Ctrl-C in %s: %d commands', code, sim.state.speed_commands);
clear cleanup
delete(sim);
end

function wait_for(file)
waited = tic();
while ~exist(file, 'file')
    check(toc(waited) < 60, 'the other program did not come so far');
    pause(0.01);
end
delete(file);
end
