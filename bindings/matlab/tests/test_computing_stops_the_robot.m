function test_computing_stops_the_robot()
% While the program computes and does not call drive, the robot is stopped within the lease and
% two periods: measured at the simulator. (That a lease does not end early either is for
% test_drives_in_virtual_time.)
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
shortest(0.25 + 2 * 0.05, 'zero after the only drive', @driven_s);
end

function seconds = driven_s()
sim = roburoc4.Simulator('port', 0);
pid = child(sim.address, '''lease_ms'', 250', ...
    'r.drive(0.3, 0); x = 0; while true, x = x + 1; end');
cleanup = onCleanup(@() kill(pid, 9));
seconds = watch_stop(sim);

% It stays so, while the program computes on.
sent = sim.state.nonzero_speed_commands;
pause(0.5);
check(sim.state.nonzero_speed_commands == sent, 'a speed was sent after the end of the lease');
clear cleanup
delete(sim);
end
