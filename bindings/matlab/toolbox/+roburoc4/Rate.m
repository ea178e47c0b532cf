classdef Rate < handle
%RATE A control loop with a fixed rate, without a timer.
%   LOOP = roburoc4.Rate(R, HERTZ), or R.rate(HERTZ), starts now; 0.1 to 200 Hz. Between two waits
%   the loop computes and drives; wait ends at the next tick of the rate. If the loop takes longer
%   than a period, the ticks that it missed are counted in overruns and skipped: it does not run
%   faster later. With a robot in virtual time, virtual time passes. A loop does not keep its robot
%   from being deleted: when R is deleted or cleared, wait raises roburoc4:closed.
%
%   Rate methods:
%      wait      - Wait for the next tick
%
%   Rate properties:
%      period_s  - Seconds between two ticks
%      overruns  - Ticks that were missed
%      time_s    - Seconds since the loop started
%
%   Example:
%      loop = r.rate(20);
%      while loop.time_s < 5
%          r.drive(0.3, 0.2 * sin(loop.time_s));
%          loop.wait();
%      end
%      r.stop()
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT

properties (SetAccess = private)
    period_s
    overruns = 0
end

properties (Access = private, Transient)
    id = 0     % not the object: clearing that must stop the robot
end

properties (Access = private)
    begin_s
    ticks = 0
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
        this.begin_s = robot.time_s;
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
        roburoc4.internal.spin(this.id, max(0, this.ticks * this.period_s - this.time_s));
    end

    function seconds = get.time_s(this)
        seconds = roburoc4_mex('now', this.id) - this.begin_s;
    end
end
end
