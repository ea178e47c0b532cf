function test_cycles_leave_no_descriptor()
% A thousand robots and simulators, opened and closed: the count of file descriptors stays.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('port', 0);
cycles = 1000;
before = NaN;
for k = 1:cycles
    id = roburoc4.internal.roburoc4_mex('open', sim.address, struct());
    if mod(k, 100) == 0
        ready = roburoc4.Robot(sim.address);       % all the way to ready, in some of them
        delete(ready);
        host = roburoc4.Simulator('port', 0);
        delete(host);
    end
    roburoc4.internal.roburoc4_mex('close', id);
    if k == 100
        before = descriptors();
    end
end
after = descriptors();
check(isequaln(before, after), '%d file descriptors after 100 cycles, %d after %d', before, ...
    after, cycles);
delete(sim);
end

function count = descriptors()
count = NaN;
if exist('/proc/self/fd', 'dir') && exist('OCTAVE_VERSION', 'builtin')
    count = numel(readdir('/proc/self/fd'));     % dir() also looks at each, but one is gone then
elseif exist('/proc/self/fd', 'dir')
    count = numel(dir('/proc/self/fd'));
end
end
