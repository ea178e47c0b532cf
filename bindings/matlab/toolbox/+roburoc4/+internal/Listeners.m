classdef Listeners < handle
%LISTENERS What Robot.listen was given, and the waiting in which it is called.
%   L = roburoc4.internal.Listeners(ID) belongs to a robot and to its rates. It has the id and not the
%   object, so that it does not keep that from being deleted: clearing the object stops the robot.
%
%   Example:
%      l = roburoc4.internal.Listeners(id); l.wait(0.02);
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT

properties (Access = private, Transient)
    id = 0
    actions = struct()
    is_calling = false
end

methods
    function this = Listeners(id)
        this.id = id;
    end

    function set(this, kind, action)
        %SET Call ACTION for each news of this kind from now on; [] ends that.
        if isempty(fieldnames(this.actions))
            roburoc4_mex('hear', this.id);
        end
        if isempty(action)
            if isfield(this.actions, kind)
                this.actions = rmfield(this.actions, kind);
            end
        else
            this.actions.(kind) = action;
        end
    end

    function now_s = wait(this, seconds)
        %WAIT Wait at most 0.1 s, and call what listens. Seconds on the robot's clock afterwards.
        if this.is_calling
            error('roburoc4:badArgument', ['an action of listen cannot call a method that waits; set a ' ...
                'variable, and let the loop do it']);
        end
        now_s = roburoc4_mex('wait', this.id, seconds);
        if ~isempty(fieldnames(this.actions))
            this.call();
        end
    end

    function sleep(this, seconds)
        %SLEEP Wait in slices short enough for Ctrl-C.
        cleanup = roburoc4.internal.guard(this.id); %#ok<NASGU>
        finish_s = roburoc4_mex('now', this.id) + seconds;
        left_s = seconds;
        while left_s > 0
            left_s = finish_s - this.wait(min(left_s, 0.05));
        end
        roburoc4_mex('busy', this.id, false);
    end
end

methods (Access = private)
    function call(this)
        this.is_calling = true;
        cleanup = onCleanup(@() this.called()); %#ok<NASGU>
        s = roburoc4_mex('news', this.id);
        while ~isempty(s)
            if isfield(this.actions, s.kind)
                action = this.actions.(s.kind);
                action(rmfield(s, 'kind'));
            end
            s = roburoc4_mex('news', this.id);
        end
    end

    function called(this)
        this.is_calling = false;
    end
end
end
