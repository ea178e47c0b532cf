function test_killed_program_stops_the_robot()
% A killed program sends no zero: the robot's own watchdog stops it.
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
sim = roburoc4.Simulator('port', 0);
pid = child(sim.address, '''lease_ms'', 1000', 'r.driveFor(0.3, 0, 30)');
cleanup = onCleanup(@() kill(pid, 9));
begun = tic();
while sim.state.wheel_linear_m_s < 0.05
    check(toc(begun) < 180, 'the robot was not driven within three minutes');
    pause(0.01);
end
kill(pid, 9);
begun = tic();
s = sim.state;
while s.target_linear_m_s ~= 0
    check(toc(begun) < 60, 'the robot drives on');
    pause(0.01);
    s = sim.state;
end
check(s.watchdog_tripped && s.last_linear_m_s ~= 0, 'a zero was sent');
clear cleanup
delete(sim);
end
