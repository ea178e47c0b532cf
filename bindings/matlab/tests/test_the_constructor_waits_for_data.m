function test_the_constructor_waits_for_data()
% After the constructor each service that is subscribed to has sent a status; one that stays silent is no
% reason to wait for ever.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
ages = {'iocard_age_s', 'telemeter_age_s', 'battery_age_s', 'localization_age_s', 'differential_age_s'};
for k = 1:numel(ages)
    check(isfinite(r.status.(ages{k})), '%s', ages{k});
end
check(~any(isnan([r.pose r.speeds])) && r.status.remaining_percent == 100, 'values');
check(r.time_s < 1.5, 'it took %g s', r.time_s);
delete(r);

r = sim.connect('wait_for_data', false);
check(r.status.battery_age_s == Inf && r.time_s < 0.5, 'it waited for %g s', r.time_s);
delete(r);
r = sim.connect('battery_period_ms', 0);
check(r.time_s < 0.5, 'it waited for a service that is not subscribed to');
delete(r);
delete(sim);
end
