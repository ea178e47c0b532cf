function driven_s = watch_stop(sim, then)
%WATCH_STOP Wait until a simulated robot is driven and stopped; measure the time between.
%   DRIVEN_S = watch_stop(SIM) is the time between the first speed and the first zero, by the clock of
%   the simulator on a port; NaN where both fell between two looks, on a busy machine.
%   watch_stop(SIM, THEN) calls THEN once it is driven for 0.3 s, and counts from there; NaN where it
%   was stopped before that, so that THEN was not called.
%
%   Example:
%      driven_s = watch_stop(sim)

% SPDX-License-Identifier: MIT
begun = tic();
first_s = [];
called_s = [];
while true
    s = sim.state;
    if isempty(first_s) && s.nonzero_speed_commands > 0
        first_s = NaN;
        if s.last_linear_m_s ~= 0
            first_s = s.last_command_s;
        end
    end
    if ~isempty(first_s) && s.last_linear_m_s == 0
        break
    end
    if nargin > 1 && ~isempty(first_s) && isempty(called_s) && s.time_s - first_s > 0.3
        called_s = s.time_s;
        then();
    end
    check(toc(begun) < 180, 'the robot was not driven and stopped within three minutes');
    pause(0.002);
end
driven_s = s.last_command_s - first_s;
if ~isempty(called_s)
    driven_s = s.last_command_s - called_s;
elseif nargin > 1
    driven_s = NaN;
end
check(s.target_linear_m_s == 0, 'a zero was sent, but the target is %g', s.target_linear_m_s);
end
