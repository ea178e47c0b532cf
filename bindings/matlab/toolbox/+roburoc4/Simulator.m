classdef Simulator < handle
%SIMULATOR A simulated RobuROC4, to try out programs without a robot.
%   SIM = roburoc4.Simulator() is a robot in virtual time: time passes only in SIM.step and in the
%   methods of a robot of SIM.connect that wait, so a program runs as fast as it can, and is
%   reproducible. SIM = roburoc4.Simulator('port', PORT) serves UDP in real time on its own
%   thread (0 picks a free port); programs connect to SIM.address.
%
%   SIM = roburoc4.Simulator('Name', value, ...) takes options: port, host ('127.0.0.1'; the address
%   of this machine to serve on, with port), seed (1), slip (0.12: the share of a turn that is lost
%   to skidding), start_x_m, start_y_m, start_theta_rad, watchdog_cycles (100), battery_percent,
%   digital_inputs, and all other numbers of roburoc4_sim_config in roburoc4_sim.h. family draws a
%   robot of the family that the manual allows (docs/PROTOCOL.md): the same one for the same number.
%   robot_file is a file of roburoc4 first-contact: the simulator is that robot.
%
%   Simulator methods:
%      connect        - Make a robot object for this simulator
%      step           - Let virtual time pass
%      panel          - Execute a line such as 'pad a down'; 'help' lists all commands
%      set            - Press a button, turn a switch, move the game pad, pin an input
%      get            - Read a control, an input or an output
%      place          - Move the robot to another place
%      addBox         - Put a box on the floor
%      addWall        - Build a wall
%      clearObstacles - Remove all boxes and walls
%      setFaults      - Make the network worse
%
%   Simulator properties:
%      state         - Everything about the simulated robot: a scalar struct
%      address       - 'HOST:PORT', or 'virtual'
%
%   Example:
%      sim = roburoc4.Simulator();
%      r = sim.connect();
%      r.arm();
%      r.driveFor(0.5, 0, 2);
%      sim.state.true_x_m
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT

properties (SetAccess = private, Hidden, Transient)
    id = 0
    host = ''
    port = 0
end

properties (Dependent, SetAccess = private)
    state
    address
end

methods
    function this = Simulator(varargin)
        %SIMULATOR Make a simulated robot.
        %   See the help of the class.
        own = struct('port', [], 'host', '');
        [options, own] = roburoc4.internal.options(varargin, own, true);
        if isempty(own.port)
            roburoc4.internal.needed(isempty(own.host), ...
                '''port'' together with ''host''; 0 picks a free port');
            own.port = 0;
        elseif isempty(own.host)
            own.host = '127.0.0.1';
        end
        if ~isempty(own.host)
            this.host = roburoc4.internal.text(own.host, 'host');
        end
        opened = roburoc4_mex('simOpen', options, this.host, own.port);
        this.id = opened(1);
        this.port = opened(2);
    end

    function delete(this)
        %DELETE End the simulation; a second delete does nothing.
        %
        %   Example:
        %      delete(sim)
        try
            roburoc4_mex('simClose', this.id);
        catch
            % The program ends: then the MEX file ends all simulators.
        end
    end

    function disp(this)
        %DISP Show the address and the state of the robot.
        %
        %   Example:
        %      disp(sim)
        try
            fprintf('  roburoc4.Simulator, %s: %s\n', this.address, this.panel('status'));
        catch
            fprintf('  roburoc4.Simulator, deleted\n');
        end
    end

    function robot = connect(this, varargin)
        %CONNECT Make a robot object for this simulator.
        %   R = connect(SIM, 'Name', value, ...) takes the options of roburoc4.Robot. In virtual
        %   time R uses the simulator's clock.
        %
        %   Example:
        %      r = sim.connect('max_linear_m_s', 0.5);
        if isempty(this.host)
            robot = roburoc4.Robot(this, varargin{:});
        else
            robot = roburoc4.Robot(this.address, varargin{:});
        end
    end

    function step(this, seconds)
        %STEP Let virtual time pass, also for the robots of connect.
        %
        %   Example:
        %      sim.step(0.5)
        roburoc4.internal.needed(nargin == 2, 'step(seconds)');
        left_s = roburoc4.internal.number(seconds, 'seconds', 0, 1e9);
        while left_s > 0
            part_s = min(left_s, 1);
            roburoc4_mex('simStep', this.id, part_s);
            left_s = left_s - part_s;
        end
    end

    function s = get.state(this)
        s = roburoc4_mex('simState', this.id);
    end

    function s = get.address(this)
        s = 'virtual';
        if ~isempty(this.host)
            s = sprintf('%s:%d', this.host, this.port);
        end
    end

    function reply = panel(this, line)
        %PANEL Execute a line of text, and return the reply; panel(SIM, 'help') lists all commands.
        %
        %   Example:
        %      sim.panel('pin analog 2 24.5')
        roburoc4.internal.needed(nargin == 2, 'panel(line), such as panel(''help'')');
        line = roburoc4.internal.text(line, 'line');
        reply = roburoc4_mex('simPanel', this.id, line);
    end

    function set(this, control, value)
        %SET Do what a person beside the robot can do; panel(SIM, 'help') lists everything.
        %   Controls are named as in roburoc4_sim.h: power, motor_button, estop_local, estop_remote,
        %   brakes_released, charger, front_bumper, rear_bumper and the game pad's buttons, pad_a to
        %   pad_rb, take true and false; battery_percent 0 to 100, its axes, pad_lj_x to pad_rt, -1
        %   to 1 (set(SIM, 'pad', 0) releases everything), localization_flags 0 to 127. While pad_a is
        %   held, the pad drives and no client does. After an emergency stop is released the motors
        %   still have no power: press motor_button. pin_analog_2 and pin_digital_8 fix what an input
        %   reports; set(SIM, 'pin', 0) undoes this.
        %
        %   Example:
        %      sim.set('pad_a', true); sim.set('pad_rt', 0.5)
        roburoc4.internal.needed(nargin == 3, 'set(control, value)');
        roburoc4_mex('simSet', this.id, control, value);
    end

    function value = get(this, control)
        %GET Read a control, an input ('pin_analog_2') or an output ('digital_output_3').
        %   Digital output 0 is the robot's watchdog.
        %
        %   Example:
        %      sim.get('digital_output_3')
        roburoc4.internal.needed(nargin == 2, 'get(control)');
        value = roburoc4_mex('simGet', this.id, control);
    end

    function place(this, x_m, y_m, theta_rad)
        %PLACE Move the robot to another place, unnoticed by its odometry.
        %
        %   Example:
        %      sim.place(1, 2, pi / 2)
        roburoc4.internal.needed(nargin == 4, 'place(x_m, y_m, theta_rad)');
        this.send('place', {x_m, y_m, theta_rad});
    end

    function addBox(this, x_m, y_m, size_x_m, size_y_m, theta_rad)
        %ADDBOX Put a box on the floor: its centre, its sizes and its orientation.
        %
        %   Example:
        %      sim.addBox(3, 0, 0.5, 0.5, 0)
        roburoc4.internal.needed(nargin == 6, 'addBox(x_m, y_m, size_x_m, size_y_m, theta_rad)');
        this.send('box add', {x_m, y_m, size_x_m, size_y_m, theta_rad});
    end

    function addWall(this, x1_m, y1_m, x2_m, y2_m)
        %ADDWALL Build a wall between two points.
        %
        %   Example:
        %      sim.addWall(3, -1, 3, 1)
        roburoc4.internal.needed(nargin == 5, 'addWall(x1_m, y1_m, x2_m, y2_m)');
        this.send('box wall', {x1_m, y1_m, x2_m, y2_m});
    end

    function clearObstacles(this)
        %CLEAROBSTACLES Remove all boxes and walls.
        %
        %   Example:
        %      sim.clearObstacles()
        this.panel('box clear');
    end

    function setFaults(this, varargin)
        %SETFAULTS Make the network worse, in both directions.
        %   setFaults(SIM, 'Name', value, ...) takes loss, duplicate, reorder and corrupt, shares of 0
        %   to 1, delay_ms and jitter_ms. Without arguments the network is perfect again.
        %
        %   Example:
        %      sim.setFaults('loss', 0.2, 'delay_ms', 10)
        [~, faults] = roburoc4.internal.options(varargin, struct('loss', 0, 'duplicate', 0, ...
            'reorder', 0, 'corrupt', 0, 'delay_ms', 0, 'jitter_ms', 0));
        faults = struct2cell(faults);
        roburoc4_mex('simFaults', this.id, faults{:});
    end
end

methods (Access = private)
    function send(this, line, numbers)
        for k = 1:numel(numbers)
            number = roburoc4.internal.number(numbers{k}, sprintf('number %d', k), -1e9, 1e9);
            line = sprintf('%s %.12f', line, number);
        end
        this.panel(line);
    end
end
end
