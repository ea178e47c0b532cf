function test_ctrl_c_stops_the_robot()
% Ctrl-C in a method that waits sends a zero at once, long before the lease of a second ends, though
% the robot object still exists. In drive the lease stays, and ends by itself.
% SPDX-License-Identifier: MIT
if ~exist('OCTAVE_VERSION', 'builtin')
    return
end
long = '''lease_ms'', 1000';
usual = '''lease_ms'', 500';
ways = {'driveFor', long, 0.8, 'INT', 'r.driveFor(0.3, 0, 30)'; ...
    'a loop of a rate', long, 0.8, 'INT', ...
        'l = r.rate(5); while true, r.drive(0.3, 0); l.wait(); end'; ...
    'record', long, 0.8, 'INT', 'while true, r.drive(0.3, 0); r.record(0.2); end'; ...
    'drive', usual, 0.5 + 2 * 0.05, 'INT', 'while true, r.drive(0.3, 0); end'; ...
    'move, terminated', long, 0.8, 'TERM', 'r.move(30, ''speed'', 0.3)'};
numbers = SIG();
for k = 1:size(ways, 1)
    shortest(ways{k, 3}, ['zero after Ctrl-C in ' ways{k, 1}], ...
        @() stopped(ways{k, 2}, ways{k, 5}, numbers.(ways{k, 4})));
end
end

function stop_s = stopped(options, code, number)
% From the signal to the zero; NaN where a busy machine let the lease end before the signal.
sim = roburoc4.Simulator('port', 0);
% The program continues after Ctrl-C, as a console does: its end would also send the zero.
pid = child(sim.address, options, sprintf( ...
    'unwind_protect, %s; unwind_protect_cleanup, pause(5); end_unwind_protect', code));
cleanup = onCleanup(@() kill(pid, 9));
stop_s = watch_stop(sim, @() kill(pid, number));
clear cleanup
delete(sim);
end
