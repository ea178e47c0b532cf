function test_unknown_is_not_false()
% What the robot has not reported is NaN, which is an error as a condition, and never false.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect('iocard_period_ms', 0, 'battery_period_ms', 0);
names = {'overridden', 'front_bumper', 'rear_bumper', 'battery_low'};
for k = 1:numel(names)
    check(isnan(r.status.(names{k})), '%s is known', names{k});
    check(is_no_condition(r.status.(names{k})), '%s is a condition', names{k});
end
check(isempty(r.status.missing), 'nothing that is wanted is missing: %s', r.status.missing);
r.subscribe('iocard', 50);
r.subscribe('battery', 500);
r.sleep(1);
for k = 1:numel(names)
    check(r.status.(names{k}) == 0, '%s is %g', names{k}, r.status.(names{k}));
end
sim.set('front_bumper', true);
r.sleep(0.2);
check(r.status.front_bumper == 1 && r.status.rear_bumper == 0, 'the bumper');
% An age is a bound: two periods and a cycle.
check(r.inputs().age_s < 0.115, 'the age of the inputs is %g s', r.inputs().age_s);
delete(r);
delete(sim);
end

function refused = is_no_condition(value)
refused = true;
try
    if value, refused = false; else, refused = false; end
catch
    % As it should.
end
end
