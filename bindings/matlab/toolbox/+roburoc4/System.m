classdef System < matlab.System
%SYSTEM A RobuROC4 as a block of Simulink, or as a System object. MATLAB R2021a or newer.
%   The block 'MATLAB System' with the System object 'roburoc4.System', or the block of the library
%   that roburoc4_library makes, is a robot. In MATLAB: S = roburoc4.System('address', ADDRESS).
%
%   Inputs: linear_m_s and angular_rad_s, and arm. The robot is armed once, when arm becomes true, and
%   stopped and disarmed when it becomes false. If something else disarms it (game pad, emergency stop, a lost link),
%   it stays disarmed until arm was false again. If arming is refused, the simulation ends.
%
%   Outputs are from before the inputs take effect, so that a control loop can be closed without an
%   algebraic loop: pose, [x_m y_m theta_rad], and speeds, [linear_m_s angular_rad_s], NaN when they
%   are old; remaining_percent, NaN when unknown; state, [ready armed overridden inhibited], NaN where
%   unknown; distances_m, [front rear] of the telemeters, and bumpers, [front rear], 1 pressed and 0
%   not, NaN when unknown or old.
%
%   Properties:
%      address           - 'HOST' or 'HOST:PORT'; '' (default) is a simulated robot
%      clock             - 'simulation' (default): the time of the model, as fast as it runs, with a
%                          simulated robot only. 'wall': each step waits for the time of day
%      sample_time_s     - Seconds between two steps, 0.01 to 0.12 (0.05): a drive command holds 0.25 s
%      max_linear_m_s    - Highest speed (0.5)
%      max_angular_rad_s - Highest turn rate (1)
%
%   While a model is paused, or slower than 0.25 s per step, the robot is stopped; it drives again when
%   the model continues within a second, and is disarmed after that. The end of the simulation and errors stop it. The block has not been run in
%   MATLAB yet: its methods are tested in Octave, with a substitute for matlab.System.
%
%   Example:
%      S = roburoc4.System();
%      for k = 1:40, pose = S(0.3, 0, true); end
%      release(S)
%
%   See also roburoc4.Robot, roburoc4_library, roburoc4_model.

% SPDX-License-Identifier: MIT

properties (Nontunable)
    address = ''
    clock = 'simulation'
    sample_time_s = 0.05
    max_linear_m_s = 0.5
    max_angular_rad_s = 1
end

properties (Constant, Hidden)
    clockSet = matlab.system.StringSet({'simulation', 'wall'})
end

properties (Access = private)
    simulator
    robot
    loop
    arm_before
end

methods
    function this = System(varargin)
        %SYSTEM Make a System object; the robot is connected by its first step.
        %   S = roburoc4.System('Name', value, ...) sets properties.
        setProperties(this, nargin, varargin{:});
    end
end

methods (Access = protected)
    function validatePropertiesImpl(this)
        roburoc4.internal.number(this.sample_time_s, 'sample_time_s', 0.01, 0.12);
        if ~isempty(this.address) && strcmp(this.clock, 'simulation')
            error('roburoc4:badArgument', ['clock: a robot at an address has its own time; set ' ...
                'clock to ''wall'', or leave address empty']);
        end
    end

    function setupImpl(this)
        limits = {'max_linear_m_s', this.max_linear_m_s, 'max_angular_rad_s', this.max_angular_rad_s};
        if ~isempty(this.address)
            this.robot = roburoc4.Robot(this.address, limits{:});
        else
            if strcmp(this.clock, 'simulation')
                this.simulator = roburoc4.Simulator();
            else
                this.simulator = roburoc4.Simulator('port', 0);
            end
            this.robot = this.simulator.connect(limits{:});
        end
        this.robot.receive('differential', 1);
        this.loop = this.robot.rate(1 / this.sample_time_s);
        this.arm_before = false;
    end

    function resetImpl(this)
        this.loop.reset();
    end

    function [pose, speeds, remaining_percent, state, distances_m, bumpers] = outputImpl(this, ~, ~, ~)
        s = this.robot.status;
        pose = this.robot.pose(1:3);
        speeds = this.robot.speeds;
        remaining_percent = double(s.remaining_percent);
        if s.remaining_percent == 255
            remaining_percent = NaN;
        end
        state = double([s.ready, s.armed, s.overridden, s.inhibited]);
        distances_m = [NaN NaN];
        seen = min(2, numel(s.distances_m));
        if s.telemeter_age_s < 0.5
            distances_m(1:seen) = s.distances_m(1:seen);
        end
        bumpers = [s.front_bumper s.rear_bumper];
        if s.iocard_age_s > 0.5
            bumpers = [NaN NaN];
        end
    end

    function updateImpl(this, linear_m_s, angular_rad_s, arm)
        arm = arm ~= 0;
        if arm && ~this.arm_before
            this.robot.arm();
        elseif ~arm && this.arm_before
            this.robot.stop();
        end
        this.arm_before = arm;
        if this.robot.status.armed
            try
                this.robot.drive(linear_m_s, angular_rad_s);
            catch problem
                % It was disarmed meanwhile; the next output shows that.
                if ~strcmp(problem.identifier, 'roburoc4:notArmed')
                    rethrow(problem);
                end
            end
        end
        this.loop.wait();
    end

    function releaseImpl(this)
        delete(this.robot);
        if ~isempty(this.simulator)
            delete(this.simulator);
        end
        this.simulator = [];
    end

    function [linear_m_s, angular_rad_s, arm] = isInputDirectFeedthroughImpl(~, ~, ~, ~)
        linear_m_s = false;
        angular_rad_s = false;
        arm = false;
    end

    function count = getNumInputsImpl(~)
        count = 3;
    end

    function count = getNumOutputsImpl(~)
        count = 6;
    end

    function [linear_m_s, angular_rad_s, arm] = getInputNamesImpl(~)
        linear_m_s = 'linear_m_s';
        angular_rad_s = 'angular_rad_s';
        arm = 'arm';
    end

    function [pose, speeds, remaining_percent, state, distances_m, bumpers] = getOutputNamesImpl(~)
        pose = 'pose';
        speeds = 'speeds';
        remaining_percent = 'remaining_percent';
        state = 'state';
        distances_m = 'distances_m';
        bumpers = 'bumpers';
    end

    function [pose, speeds, remaining_percent, state, distances_m, bumpers] = getOutputSizeImpl(~)
        pose = [1 3];
        speeds = [1 2];
        remaining_percent = [1 1];
        state = [1 4];
        distances_m = [1 2];
        bumpers = [1 2];
    end

    function [pose, speeds, remaining_percent, state, distances_m, bumpers] = getOutputDataTypeImpl(~)
        pose = 'double';
        speeds = 'double';
        remaining_percent = 'double';
        state = 'double';
        distances_m = 'double';
        bumpers = 'double';
    end

    function [pose, speeds, remaining_percent, state, distances_m, bumpers] = isOutputComplexImpl(~)
        pose = false;
        speeds = false;
        remaining_percent = false;
        state = false;
        distances_m = false;
        bumpers = false;
    end

    function [pose, speeds, remaining_percent, state, distances_m, bumpers] = isOutputFixedSizeImpl(~)
        pose = true;
        speeds = true;
        remaining_percent = true;
        state = true;
        distances_m = true;
        bumpers = true;
    end

    function choice = getSampleTimeImpl(this)
        choice = createSampleTime(this, 'Type', 'Discrete', 'SampleTime', this.sample_time_s);
    end

    function icon = getIconImpl(~)
        icon = 'RobuROC4';
    end
end

methods (Static, Access = protected)
    function choice = getSimulateUsingImpl()
        choice = 'Interpreted execution';
    end

    function shown = showSimulateUsingImpl()
        shown = false;
    end
end
end
