function test_computing_stops_the_robot()
% While the program computes and does not call drive, the robot is stopped within the lease and
% two periods: measured at the simulator. The margin is for a loaded machine. (That a lease does not
% end early either is for test_drives_in_virtual_time.)
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
sim = roburoc4.Simulator('port', 0);
pid = child(sim.address, '''lease_ms'', 250', ...
    'r.drive(0.3, 0); x = 0; while true, x = x + 1; end');
cleanup = onCleanup(@() kill(pid, 9));
driven_s = watch_stop(sim);
check(driven_s <= 0.25 + 2 * 0.05 + 0.15, 'stopped only after %g s', driven_s);
fprintf('       zero %.0f ms after the only drive; lease and two periods: 350 ms\n', ...
    1000 * driven_s);

% It stays so, while the program computes on.
sent = sim.state.nonzero_speed_commands;
pause(0.5);
check(sim.state.nonzero_speed_commands == sent, 'a speed was sent after the end of the lease');
clear cleanup
delete(sim);
end
