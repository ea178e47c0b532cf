function test_clear_with_live_robots()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('port', 0);
r = sim.connect('fresh_ms', 1000);   % a loaded machine does not disarm it
r.arm();
r.drive(0.3, 0);
clear mex
clear functions
clear roburoc4_mex
check(living_robots() == 1, 'the MEX file was not locked');
r.drive(0.3, 0);
delete(r);
check(sim.state.target_linear_m_s == 0 && sim.state.last_linear_m_s == 0, 'no zero at the robot');
delete(r);
clear r

% An object that is forgotten stops its robot too.
forgotten = sim.connect('fresh_ms', 1000);
forgotten.arm();
forgotten.drive(0.3, 0);
clear forgotten
check(sim.state.target_linear_m_s == 0 && sim.state.last_linear_m_s == 0, 'no zero at the robot');
check(living_robots() == 0, 'the robot lives on');
delete(sim);
end
