function test_statuses_have_plain_types()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('start_x_m', 1.5);
r = sim.connect();
r.sleep(1.5);
look(r.status);
look(r.info);
look(r.link);
look(sim.state);
check(isa(r.status.robot_cycles, 'uint64') && r.status.robot_cycles >= 150, 'robot cycles');
check(islogical(r.status.ready) && r.status.ready, 'ready');
check(isa(r.status.remaining_percent, 'uint8') && r.status.remaining_percent == 100, 'battery');
check(r.status.battery_state == roburoc4.BatteryState.OK, 'battery state');
check(bitand(r.status.localization_flags, roburoc4.LocalizationFlag.INVALID) == 0, 'flags');
check(isequal(size(r.status.distances_m), [1 2]), 'distances');
check(r.status.x_m == 1.5 && isequal(r.pose(1:3), [1.5 0 0]), 'pose');
check(abs(r.info.max_linear_m_s - 2.6) < 1e-6 && r.info.digital_inputs == 22, 'info');
check(isequal(r.info.service_ids, 0:6), 'service ids');
check(r.link.received > 0 && period_s(r) == 1, 'link');

% Before the first status: NaN and 255.
quiet = sim.connect('battery_period_ms', 0, 'localization_period_ms', 0);
check(isnan(quiet.status.x_m) && all(isnan(quiet.pose)), 'a pose before the first status');
check(quiet.status.battery_state == roburoc4.BatteryState.NOT_KNOWN, 'a battery state before the first status');
figures = quiet.serviceLink('battery');
check(~figures.subscribed, 'subscribed');
quiet.subscribe('localization', 20);
quiet.sleep(0.2);
check(quiet.status.x_m == 1.5, 'subscribe');
quiet.unsubscribe('localization');
delete(quiet);
delete(r);
delete(sim);
end

function seconds = period_s(r)
figures = r.serviceLink('battery');
seconds = figures.period_s;
end

function look(s)
check(isstruct(s) && isscalar(s), 'not a scalar struct');
names = fieldnames(s);
for k = 1:numel(names)
    value = s.(names{k});
    kinds = {'double', 'logical', 'uint8', 'uint64', 'char'};
    check(any(strcmp(class(value), kinds)), '%s is %s', names{k}, class(value));
    check(size(value, 1) == 1 || isempty(value), '%s is no row', names{k});
    check(~isa(value, 'uint64') || strcmp(names{k}, 'robot_cycles'), '%s is uint64', names{k});
end
end
