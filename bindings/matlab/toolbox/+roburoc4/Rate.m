classdef Rate < handle
%RATE A control loop with a fixed rate, without a timer.
%   LOOP = roburoc4.Rate(R, HERTZ), or R.rate(HERTZ), starts now; 0.1 to 200 Hz. Between two waits
%   the loop computes and drives; wait ends at the next tick of the rate. If the loop takes longer
%   than a period, the ticks that it missed are counted in overruns and skipped: it does not run
%   faster later. With a robot in virtual time, virtual time passes. A loop does not keep its robot
%   alive: when R is deleted or cleared, wait raises roburoc4:closed.
%
%   Rate methods:
%      wait          - Wait for the next tick
%      reset         - Start again from now
%      statistics    - How even the periods were
%
%   Rate properties:
%      period_s      - Seconds between two ticks
%      last_period_s - Seconds between the last two ends of wait, NaN before
%      overruns      - Ticks that were missed
%      time_s        - Seconds since the loop started
%
%   Example:
%      loop = r.rate(20);
%      while loop.time_s < 5
%          r.drive(0.3, 0.2 * sin(loop.time_s));
%          loop.wait();
%      end
%      r.pause()
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT

properties (SetAccess = private)
    period_s
    last_period_s
    overruns
end

properties (Access = private, Transient)
    id = 0     % not the object, because clearing that must stop the robot
    listeners
end

properties (Access = private)
    begin_s
    ended_s                 % the last wait
    ticks
    figures                 % of the periods: their number, sum, sum of squares, least and most
end

properties (Dependent, SetAccess = private)
    time_s
end

methods
    function this = Rate(robot, hertz)
        %RATE Start a loop.
        %   See the help of the class.
        roburoc4.internal.needed(nargin == 2 && isa(robot, 'roburoc4.Robot'), ...
            'Rate(a roburoc4.Robot, hertz), or r.rate(hertz)');
        this.period_s = 1 / roburoc4.internal.number(hertz, 'hertz', 0.1, 200);
        this.id = robot.id;
        this.listeners = robot.listeners;
        this.reset();
    end

    function reset(this)
        %RESET Start again from now: time_s, the ticks, overruns and statistics.
        %
        %   Example:
        %      loop.reset()
        this.begin_s = roburoc4_mex('now', this.id);
        this.ticks = 0;
        this.overruns = 0;
        this.ended_s = 0;
        this.last_period_s = NaN;
        this.figures = [0 0 0 NaN NaN];
    end

    function wait(this)
        %WAIT Wait for the next tick; Ctrl-C stops the robot.
        %
        %   Example:
        %      loop.wait()
        past = floor((this.time_s + 1e-9) / this.period_s);
        if past > this.ticks
            this.overruns = this.overruns + past - this.ticks;
            this.ticks = past;
        end
        this.ticks = this.ticks + 1;
        this.listeners.sleep(max(0, this.ticks * this.period_s - this.time_s));
        now_s = this.time_s;
        this.last_period_s = now_s - this.ended_s;
        this.ended_s = now_s;
        p = this.last_period_s;
        f = this.figures;
        this.figures = [f(1:3) + [1 p p ^ 2], min(f(4), p), max(f(5), p)];
    end

    function s = statistics(this)
        %STATISTICS How even the periods were, from one end of wait to the next.
        %   S = statistics(LOOP) is a scalar struct: periods, how many; mean_s, std_s, min_s and max_s,
        %   NaN before the first; overruns.
        %
        %   Example:
        %      s = loop.statistics(); s.std_s
        f = this.figures;
        s.periods = f(1);
        s.mean_s = f(2) / f(1);
        s.std_s = sqrt(abs(f(3) / f(1) - s.mean_s ^ 2));
        s.min_s = f(4);
        s.max_s = f(5);
        s.overruns = this.overruns;
    end

    function seconds = get.time_s(this)
        seconds = roburoc4_mex('now', this.id) - this.begin_s;
    end
end
end
