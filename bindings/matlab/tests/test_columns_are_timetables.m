function test_columns_are_timetables()
% record and log return timetables where there are such: with stand-ins in Octave. A MAT-file has structs.
% SPDX-License-Identifier: MIT
octave = exist('OCTAVE_VERSION', 'builtin') ~= 0;
folder = fullfile(fileparts(mfilename('fullpath')), 'timetable');
if octave
    addpath(folder);
    cleanup = onCleanup(@() rmpath(folder)); %#ok<NASGU>
end
sim = roburoc4.Simulator();
r = sim.connect();
data = r.record(1);
check(data.lost == 0 && data.start_utc_s > 0, 'what the services share');
services = {'iocard', 'telemeter', 'battery', 'localization', 'differential'};
for k = 1:numel(services)
    table = data.(services{k});
    check(numel(table.Time) == numel(table.time_s) && numel(table.time_s) > 0, services{k});
end
again = roburoc4.asTimetable(data.battery);
check(isequal(again.time_s, data.battery.time_s), 'of a timetable');
file = [tempname() '.mat'];
removal = onCleanup(@() delete(file)); %#ok<NASGU>
data = r.log(file, 'telemeter', 'battery');
check(size(data.telemeter.distances_m, 1) == numel(data.telemeter.Time), 'log');
written = load(file);
check(isstruct(written.telemeter) && ~isfield(written.telemeter, 'Time'), 'the MAT-file');
data = r.log('', 'battery');
check(isempty(data.battery.Time), 'nothing arrived since');
delete(r);
delete(sim);
end
