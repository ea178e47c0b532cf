function test_bad_networks_are_noticed()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
sim.setFaults('loss', 0.3, 'delay_ms', 5);
r.sleep(10);
check(r.link.loss > 0.1 && r.link.loss < 0.5, 'loss %g', r.link.loss);
check(r.link.lost > 0, 'nothing lost');
sim.setFaults();
r.sleep(20);
check(r.link.loss < 0.05, 'loss %g after the repair', r.link.loss);
r.arm();
sim.setFaults('loss', 1);
r.drive(0.5, 0);
r.sleep(3);
check(~r.status.ready && ~r.status.armed, 'silence was not noticed');
check_raises('roburoc4:notArmed', @() r.drive(0.5, 0));
delete(r);
delete(sim);
end
