function test_close_gives_subscriptions_back()
% close and delete end the subscriptions, also of a robot that keeps them until it is switched off, and
% stop a robot that they drive; but not while somebody else drives it.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('keep_subscriptions', true);
for finish = {@close, @delete}
    r = sim.connect();
    r.arm();
    r.drive(0.3, 0);
    r.sleep(0.2);
    finish{1}(r);
    check(sim.state.subscriptions == 0, '%d subscriptions are left', sim.state.subscriptions);
    check(abs(sim.state.target_linear_m_s) < 1e-6, 'it still drives');
    check_raises('roburoc4:closed', @() r.stop());
end
delete(sim);

% One list for all: another program that drives keeps its statuses.
sim = roburoc4.Simulator('keep_subscriptions', true, 'subscription_lists', 1);
driver = sim.connect();
r = sim.connect();
driver.arm();
driver.drive(0.3, 0);
driver.sleep(0.1);
driver.drive(0.3, 0);
before = sim.state.subscriptions;
delete(r);
check(sim.state.subscriptions == before, '%d of %d are left', sim.state.subscriptions, before);
delete(driver);
delete(sim);

% With losses, too; an object whose robot cannot be asked is closed all the same.
sim = roburoc4.Simulator('keep_subscriptions', true, 'seed', 3);
r = sim.connect();
sim.setFaults('loss', 0.1);
close(r);
check(sim.state.subscriptions == 0, '%d subscriptions are left', sim.state.subscriptions);
r = sim.connect();
delete(sim);
close(r);
end
