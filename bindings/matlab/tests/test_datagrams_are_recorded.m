function test_datagrams_are_recorded()
% The option record: a file that begins as pcapng does, and grows with what is sent and received.
% SPDX-License-Identifier: MIT
file = [tempname() '.pcapng'];
sim = roburoc4.Simulator('port', 0);
r = roburoc4.Robot(sim.address, 'record', file);
statuses = 10;
for k = 1:statuses
    r.receive('differential', 60);
end
delete(r);
recorded = fopen(file);
bytes = fread(recorded, Inf, '*uint8');
fclose(recorded);
delete(file);
check(isequal(bytes(1:4)', uint8([10 13 13 10])), 'not a pcapng file');
check(numel(bytes) > 100 * statuses, 'only %d bytes', numel(bytes));
check_raises('roburoc4:badArgument', @() roburoc4.Robot(sim.address, 'record', tempdir_none()));
table = [tempname() '.csv'];
check_raises('roburoc4:badArgument', @() roburoc4.Robot(sim.address, 'record', table));
check(~exist(table, 'file'), 'a capture is named as a table is');
delete(sim);

virtual = roburoc4.Simulator();
check_raises('roburoc4:badArgument', @() virtual.connect('record', file));
delete(virtual);
end

function path = tempdir_none()
path = fullfile(tempname(), 'run.pcapng');
end
