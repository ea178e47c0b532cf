function test_ages_are_reported()
% The latest values come with their ages; pose and speeds, for control loops, are NaN when too old.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('start_x_m', 1.5);
r = sim.connect();
patient = sim.connect('fresh_ms', 1000);
r.sleep(1.5);
ages = {'iocard_age_s', 'telemeter_age_s', 'battery_age_s', 'localization_age_s', ...
    'differential_age_s'};
longest_s = [0.06 0.11 1.01 0.06 0.06];
drift_s = 0.002; % by how much the clocks may have drifted since the last proof
for k = 1:numel(ages)
    age_s = r.status.(ages{k});
    check(age_s >= 0 && age_s <= longest_s(k) + drift_s, '%s is %g', ages{k}, age_s);
end

% One service falls silent; the robot can still be driven.
r.unsubscribe('localization');
r.sleep(0.2);
check(isequal(r.pose(1:3), [1.5 0 0]), 'a pose of 0.2 s is fresh');
r.sleep(0.5);
check(isequal(isnan(r.pose), true(1, 4)), 'a pose of 0.7 s is no NaN');
check(~any(isnan(r.speeds)), 'speeds are fresh');
age_s = r.status.localization_age_s;
check(r.status.x_m == 1.5 && age_s >= 0.69 && age_s < 0.8, ...
    'status has the last pose, and how old it can be: %g s', age_s);

% All of them do.
sim.setFaults('loss', 1);
r.sleep(0.5);
check(all(isnan(r.speeds)) && r.status.differential_age_s > 0.4, 'old speeds');
check(~any(isnan([patient.pose, patient.speeds])), 'fresh_ms 1000 was not heeded');
patient.sleep(0.6);
check(all(isnan([patient.pose, patient.speeds])), 'old values, with fresh_ms 1000');
sim.setFaults();
r.sleep(3);
check(~any(isnan(r.speeds)), 'the robot is there again');

% Never reported.
quiet = sim.connect('localization_period_ms', 0);
check(quiet.status.localization_age_s == Inf, 'the age of nothing');
check(quiet.status.localization_flags == 2 ^ 32 - 1, 'flags that nobody reported');
delete(quiet);
delete(patient);
delete(r);
delete(sim);
end
