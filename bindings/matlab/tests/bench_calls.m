function bench_calls()
%BENCH_CALLS Print what a call costs, in microseconds: the fastest and the median of 300 rounds of
%   20 calls. On a busy machine only the fastest counts.
%   The robot is a simulator on a port of this machine, so that drive really sends a datagram.
%   bench/matlab runs it.
%
%   Example:
%      bench_calls()

% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('port', 0);
r = sim.connect();
r.arm();
r.sleep(1.2);
fprintf('%-44s %9s %9s %5s\n', 'microseconds a call', 'fastest', 'median', 'aim');
measure('r.drive(0.2, 0)', @() r.drive(0.2, 0), 20);
measure('s = r.status (all of it)', @() r.status, NaN);
delete(r);
delete(sim);
end

function measure(name, action, aim_us)
rounds_us = zeros(1, 300);
for k = 1:numel(rounds_us)
    begun = tic();
    for n = 1:20
        action();
    end
    rounds_us(k) = toc(begun) / 20 * 1e6;
end
text = '';
if ~isnan(aim_us)
    text = sprintf('%5.0f', aim_us);
end
fprintf('%-44s %9.1f %9.1f %s\n', name, min(rounds_us), median(rounds_us), text);
end
