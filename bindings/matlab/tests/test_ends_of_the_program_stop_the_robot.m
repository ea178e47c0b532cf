function test_ends_of_the_program_stop_the_robot()
% Each way out of a program that drives sends a zero long before the robot's own watchdog (1 s). What
% falls between two looks of a busy machine has no measured time.
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
drive = 'r.drive(0.3, 0); r.spin(0.02); r.drive(0.3, 0); ';
ways = {'exit', [drive 'exit(0)']; ...
    'an error', [drive 'error(''no'')']; ...
    'clear all', [drive 'clear all; pause(3)']; ...
    'delete', [drive 'delete(r); delete(r); clear r; pause(3)']; ...
    'an error in a loop', 'for k = 1:9, r.drive(0.3, 0); r.spin(0.02); end; r.spin(''x'')'};
for k = 1:size(ways, 1)
    sim = roburoc4.Simulator('port', 0);
    pid = child(sim.address, ways{k, 2});
    cleanup = onCleanup(@() kill(pid, 9));
    driven_s = watch_stop(sim);
    fprintf('       %s: zero after %.0f ms\n', ways{k, 1}, 1000 * driven_s);
    check(~(driven_s >= 0.6), '%s: zero only after %g s', ways{k, 1}, driven_s);
    clear cleanup
    delete(sim);
end

% Ctrl-C in methods that wait, and a polite end from outside: zero at once, not after the lease.
waits = {'driveFor', 'r.driveFor(0.3, 0, 30)', 'INT'; ...
    'spin', 'while true, r.drive(0.3, 0); r.spin(0.1); end', 'INT'; ...
    'a loop of a rate', 'l = r.rate(20); while true, r.drive(0.3, 0); l.wait(); end', 'INT'; ...
    'record', 'while true, r.drive(0.3, 0); r.record(0.1); end', 'INT'; ...
    'driveFor, terminated', 'r.driveFor(0.3, 0, 30)', 'TERM'};
numbers = SIG();
for k = 1:size(waits, 1)
    sim = roburoc4.Simulator('port', 0);
    pid = child(sim.address, waits{k, 2});
    cleanup = onCleanup(@() kill(pid, 9));
    stop_s = watch_stop(sim, @() kill(pid, numbers.(waits{k, 3})));
    fprintf('       Ctrl-C in %s: zero after %.0f ms\n', waits{k, 1}, 1000 * stop_s);
    check(~(stop_s >= 0.6), '%s: zero only after %g s', waits{k, 1}, stop_s);
    clear cleanup
    delete(sim);
end
end
