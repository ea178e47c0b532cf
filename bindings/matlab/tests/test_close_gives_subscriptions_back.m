function test_close_gives_subscriptions_back()
% close ends the subscriptions, also of a robot that keeps them until it is switched off, and stops a
% robot that it drives; delete keeps them.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('keep_subscriptions', true);
for k = 1:3
    r = sim.connect();
    r.arm();
    r.drive(0.3, 0);
    r.sleep(0.2);
    close(r);
    check(sim.state.subscriptions == 0, '%d subscriptions are left', sim.state.subscriptions);
    check(abs(sim.state.target_linear_m_s) < 1e-6, 'it still drives');
    check_raises('roburoc4:closed', @() r.stop());
end
r = sim.connect();
delete(r);
check(sim.state.subscriptions == 5, 'delete ended subscriptions: %d are left', sim.state.subscriptions);
delete(sim);

% With losses, too; a robot that cannot be asked is deleted all the same.
sim = roburoc4.Simulator('keep_subscriptions', true, 'seed', 3);
r = sim.connect();
sim.setFaults('loss', 0.1);
close(r);
check(sim.state.subscriptions == 0, '%d subscriptions are left', sim.state.subscriptions);
r = sim.connect();
delete(sim);
check_raises('roburoc4:closed', @() r.close());
delete(r);
end
