function test_times_are_known()
% Each status and each pose has the time when the robot made it, also as UTC; the next status can be
% waited for.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
sim.setFaults('delay_ms', 40, 'jitter_ms', 40);
r = sim.connect('localization_period_ms', 20);
r.arm();
r.sleep(1);

% In virtual time UTC is the simulator's time: no jitter is left in it, and half the round trip.
data = r.record(2);
check(abs(data.start_utc_s - (sim.state.time_s - 2)) < 0.02, 'the start: %g s', data.start_utc_s);
check(max(abs(data.localization.utc_s - data.start_utc_s - data.localization.time_s)) > 0.02, ...
    'there was to be a jitter');
steps_s = diff(data.localization.utc_s(51:end));
check(max(abs(steps_s - 0.02)) < 0.005, 'the steps of UTC are %g to %g s', min(steps_s), max(steps_s));
made_s = double(data.localization.robot_cycles) * roburoc4.Service.CYCLE_S;
state = sim.state;
behind_s = state.time_s - double(state.robot_cycles) * roburoc4.Service.CYCLE_S;
late_s = data.localization.utc_s(51:end) - made_s(51:end) - behind_s;
check(all(abs(late_s) < 0.03), 'late by %g s', max(abs(late_s)));
check(isequal(fieldnames(roburoc4.asTimetable(data.battery)), fieldnames(data.battery)) || ...
    ~exist('OCTAVE_VERSION', 'builtin'), 'Octave has no timetables');

% A pose is older than the time since it arrived.
p = r.pose;
age_s = r.time_s - p(4);
check(age_s >= 0.03 && age_s <= 0.15, 'the pose is %g s old', age_s);
check(abs(r.start_utc_s + r.time_s - sim.state.time_s) < 1e-3, 'the start of the robot''s time');

% The next status, not the last one.
before_s = r.time_s;
s = r.receive('localization', 1);
check(s.time_s >= before_s && s.time_s <= before_s + 0.1, 'it came after %g s', s.time_s - before_s);
check(isequal(fieldnames(s)', {'time_s', 'utc_s', 'robot_cycles', 'x_m', 'y_m', 'theta_rad', ...
    'localization_flags'}), 'fields');
s = r.receive('iocard');
check(islogical(s.digital_inputs) && numel(s.analog_inputs) == 9, 'inputs');
sim.setFaults('loss', 1);
r.sleep(0.2);
check_raises('roburoc4:timeout', @() r.receive('battery', 0.3));
sim.setFaults();
delete(r);
delete(sim);

% In real time UTC is the time of day.
live = roburoc4.Simulator('port', 0);
r = live.connect();
begun_s = time();
s = r.receive('differential', 60);
is_now(s.utc_s, begun_s);
recorded_s = [];
while isempty(recorded_s)
    begun_s = time();
    data = r.record(0.2, 'differential');
    recorded_s = data.differential.utc_s;
end
is_now(recorded_s(end), begun_s);
delete(r);
delete(live);
end

function is_now(utc_s, begun_s)
% A status may arrive later than it was made.
check(utc_s > begun_s - 5 && utc_s <= time(), 'UTC is off by %g s', utc_s - begun_s);
end
