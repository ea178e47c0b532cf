classdef bench_robot < handle
%BENCH_ROBOT A copy of roburoc4.Robot on a MEX file that does nothing.
%   Its methods are those of roburoc4.Robot, line by line: their time is the interpreter's share.
%
%   Example:
%      r = bench_robot(); r.drive(0.2, 0)
%
%   See also bench_calls.

% SPDX-License-Identifier: MIT

properties
    id = 5
end

properties (Dependent)
    pose
    speeds
end

methods
    function drive(this, linear_m_s, angular_rad_s)
        if nargin < 3
            roburoc4.internal.needed(false, 'drive(v in m/s, w in rad/s)');
        end
        bench_mex('drive', this.id, linear_m_s, angular_rad_s);
    end

    function row = get.pose(this)
        row = bench_mex('pose', this.id);
    end

    function row = get.speeds(this)
        row = bench_mex('speeds', this.id);
    end
end
end
