function test_records_and_logs()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect('localization_period_ms', 20);
r.arm();
r.sleep(0.5);
data = r.record(2);
check(isequal(sort(fieldnames(data))', {'battery', 'differential', 'iocard', 'localization', ...
    'lost', 'start_utc_s', 'telemeter'}), 'fields');
check(numel(data.localization.x_m) == 100, '%d localizations', numel(data.localization.x_m));
check(isa(data.localization.robot_cycles, 'uint64'), 'cycles');
check(all(diff(double(data.localization.robot_cycles)) == 2), 'a status is missing');
check(size(data.telemeter.distances_m, 2) == 2 && size(data.iocard.analog_inputs, 2) == 9, 'rows');
check(islogical(data.iocard.digital_inputs) && size(data.iocard.digital_inputs, 2) == 22, 'inputs');
check(all(data.localization.time_s > 0 & data.localization.time_s <= 2), 'times');
check(data.lost == 0, 'lost');
some = r.record(0.1, 'battery');
check(isfield(some, 'battery') && ~isfield(some, 'iocard'), 'only one service was wanted');
begun_s = sim.state.time_s;
check_raises('roburoc4:badArgument', @() r.record(5, 'localisation'));
check(sim.state.time_s == begun_s, 'a wrong name was noticed only after the recording');

file = [tempname() '.mat'];
r.log(file);
r.driveFor(0.5, 0, 1);
written = r.log(file);
read = load(file);
check(isequal(read, written), 'the file differs from what was written');
check(max(read.differential.current_linear_m_s) > 0.3, 'the drive is not in the log');
check(numel(read.localization.x_m) == 50, '%d in the log', numel(read.localization.x_m));
delete(file);

% A new log can begin, and end, without a file.
r.log();
r.sleep(1);
data = r.log('', 'localization');
check(numel(data.localization.x_m) == 50 && ~isfield(data, 'battery'), 'log without a file');
check(isempty(evalc('r.log()')), 'a log that nobody wants is printed');

% If the buffer is too small, the lost statuses are counted.
small = sim.connect('buffer', 16);
small.sleep(2);
state = warning('off', 'roburoc4:limit');
lossy = small.log(file);
warning(state);
check(lossy.lost > 50, 'lost %d', lossy.lost);
delete(file);
delete(small);

% A robot that is off is an error, not an empty record.
sim.set('power', false);
r.sleep(3);
check_raises('roburoc4:timeout', @() r.record(0.5));
delete(r);
delete(sim);
end
