function test_cycles_leave_no_descriptor()
% Hundreds of robots and simulators, opened and closed: the count of file descriptors stays, and so
% does the memory. (Not with a sanitizer, which keeps what was freed.)
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('port', 0);
cycles = 300;
for k = 1:cycles
    id = roburoc4_mex('open', sim.address, struct(), 16, '');
    if mod(k, 100) == 0
        all_the_way(sim);
    end
    roburoc4_mex('close', id);
    if k == 100
        before = [descriptors(), memory_kb()];
    end
end
after = [descriptors(), memory_kb()];
check(isequaln(before(1), after(1)), '%d file descriptors after 100 cycles, %d after %d', ...
    before(1), after(1), cycles);
grown_kb = after(2:3) - before(2:3);
if isempty(getenv('ASAN_OPTIONS'))
    check(~(grown_kb > [65536 4096]), 'memory grew by %d KiB, %d of it resident', grown_kb);
end
delete(sim);
end

function all_the_way(sim)
% A robot until it is ready, a simulator on a port, and both in virtual time.
ready = roburoc4.Robot(sim.address);
delete(ready);
host = roburoc4.Simulator('port', 0);
delete(host);
world = roburoc4.Simulator();
r = world.connect();
r.record(0.1);
r.info;
delete(r);
delete(world);
end

function count = descriptors()
count = NaN;
if exist('/proc/self/fd', 'dir') && exist('OCTAVE_VERSION', 'builtin')
    count = numel(readdir('/proc/self/fd'));     % dir() also looks at each, but one is gone then
elseif exist('/proc/self/fd', 'dir')
    count = numel(dir('/proc/self/fd'));
end
end

function sizes = memory_kb()
% All of it, and what is resident.
sizes = [NaN NaN];
if exist('/proc/self/status', 'file')
    text = fileread('/proc/self/status');
    found = regexp(text, 'Vm(?:Size|RSS):\s*(\d+)', 'tokens');
    sizes = [str2double(found{1}{1}), str2double(found{2}{1})];
end
end
