function test_drives_in_virtual_time()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
check_raises('roburoc4:notArmed', @() r.drive(0.5, 0));
r.arm();
r.driveFor(0.5, 0, 2);
r.sleep(3);
moved_m = sim.state.true_x_m;
check(moved_m > 0.8 && moved_m < 1.1, 'moved %g m', moved_m);
check(r.speeds(1) == r.status.current_linear_m_s, 'speeds and status differ');
check(abs(r.pose(1) - moved_m) < 0.1, 'the odometry is at %g', r.pose(1));

% A lease ends by itself, virtual time or not.
r.drive(0.5, 0);
sim.step(0.2);
check(sim.state.target_linear_m_s == 0.5, 'the lease ended early');
sim.step(0.2);
check(sim.state.target_linear_m_s == 0, 'the lease did not end');

% Speeds are clamped; stop and the game pad stop.
fast = sim.connect('max_linear_m_s', 0.3);
r.stop();
sim.step(3);
fast.arm();
fast.drive(2, 0);
sim.step(0.05);
check(abs(sim.state.target_linear_m_s - 0.3) < 1e-6, 'target %g', sim.state.target_linear_m_s);
sim.set('pad_a', true);
sim.step(0.2);
check(fast.status.overridden && ~fast.status.armed, 'the override was not seen');
check(fast.status.disarm_cause == roburoc4.Result.OVERRIDE, 'wrong cause');
check_raises('roburoc4:notArmed', @() fast.drive(0.1, 0));
sim.set('pad_a', false);
delete(fast);
delete(r);
delete(sim);
end
