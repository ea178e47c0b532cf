function test_ends_of_the_program_stop_the_robot()
% Each way out of a program that drives sends a zero at once: long before the lease of a second ends.
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
drive = 'r.drive(0.3, 0); r.sleep(0.02); r.drive(0.3, 0); ';
mistake = 'try, careless(''%s''); catch, end; pause(3)';
ways = {'exit', [drive 'exit(0)']; ...
    'an error', [drive 'error(''no'')']; ...
    'clear all', [drive 'clear all; pause(3)']; ...
    'delete', [drive 'delete(r); delete(r); clear r; pause(3)']; ...
    'an error in a function that made it', ['delete(r); ' mistake]};
for k = 1:size(ways, 1)
    shortest(0.9, ['zero after ' ways{k, 1}], @() driven_s(ways{k, 2}));
end
end

function seconds = driven_s(code)
sim = roburoc4.Simulator('port', 0);
pid = child(sim.address, '''lease_ms'', 1000', strrep(code, '%s', sim.address));
cleanup = onCleanup(@() kill(pid, 9));
seconds = watch_stop(sim);
clear cleanup
delete(sim);
end
