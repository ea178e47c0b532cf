classdef Robot < handle
%ROBOT A RobuROC4: drive it, read it, record it.
%   R = roburoc4.Robot(ADDRESS) connects to the robot at 'HOST' or 'HOST:PORT' (from the factory
%   '192.168.0.2') and waits until it is ready and each service has sent a status.
%   R = roburoc4.Robot(ADDRESS, 'Name', value, ...) takes options:
%
%      timeout (10)              seconds without an answer, or without progress towards ready, after
%                                which roburoc4:timeout is raised
%      wait_for_data (true)      false: do not wait for the first statuses
%      lease_ms (250)            duration of a drive command, 20 to 1000
%      drive_period_ms (50)      how often a command is repeated, 10 to half of lease_ms
%                                and of robot_watchdog_ms
%      max_linear_m_s (1)        highest speed, before and after it is scaled, 0.001 to 5
%      max_angular_rad_s (1.5)   highest turn rate, likewise, 0.001 to 10
%      scale_linear (1), scale_angular (1)   factors for the speeds given to drive,
%                                             and of what the wheels count (calibration)
%      robot_file                file of roburoc4 first-contact or calibrate: ids, inputs, watchdog
%                                and scales of this robot; other options take precedence
%      keep_curvature (false)    at a limit, slow down so that the curve stays the same
%      iocard_period_ms (50), telemeter_period_ms (100), battery_period_ms (1000),
%      localization_period_ms (50), differential_period_ms (50)
%                                how often the robot sends each status: a multiple of 10, 10 to
%                                2550, or 0 for never; of iocard and differential
%                                at most a third of fresh_ms
%      buffer (10000)            statuses that are kept for record and log, 16 to 1000000; the
%                                default is two minutes
%      record                    file (.pcapng) in which every datagram is recorded, or a folder
%      fresh_ms (300)            maximum age of a status that counts for driving, pose and speeds,
%                                50 to 1000
%      lost_ms (1000)            silence after which the robot is lost, 200 to 60000
%      first_retry_ms (100)      a request is repeated after this, 10 to 100
%      robot_watchdog_ms (1000)  the robot's own watchdog, 100 to 60000
%      lapse_disarm_ms (1000)    a lease that expired disarms after this, 0 to 60000
%      iocard_id, differential_id, override_index, front_bumper_index, rear_bumper_index,
%      battery_voltage_index (-1: find it)   id of a service or index of an input, where the
%                                robot's types and texts do not tell
%      allow_unknown_override (false), ignore_other_commander (false)   weaken a protection: read
%                                docs/SAFETY.md
%
%   A native thread keeps the link alive whatever MATLAB does. It never renews a drive command: the
%   robot stops when drive is not called again within lease_ms, and is disarmed a second later. It
%   also stops at delete(R), clear R, Ctrl-C or an error in a method that waits, and the end of
%   MATLAB, if R drives it: an object that only reads never commands the robot.
%
%   Units are SI and radians; X is forward, Y left, angles counter-clockwise. Errors have the ids
%   roburoc4:badArgument, :closed, :limit (too many objects or statuses, a full disk), :moveEnded,
%   :network, :notArmed, :notBuilt (no MEX file for this program), :protocol (the robot refused, or
%   has not reported the value yet) and :timeout.
%
%   Robot methods:
%      drive           - Drive at two speeds, for one lease
%      driveFor        - Drive for some seconds, and stop
%      move            - Drive straight ahead, and wait until the robot is at rest
%      turn            - Turn in place
%      moveFor         - Drive for some seconds with gentle ramps
%      arc             - Drive along an arc
%      goTo            - Go to a point, or to a pose
%      rest            - Stop, and wait until the robot is at rest
%      stop            - Stop now, and disarm
%      pause           - Stop now, and stay armed
%      arm             - Allow driving
%      sleep           - Wait
%      rate            - Make a loop with a fixed rate
%      receive         - Wait for the next status of a service
%      inputs          - Read inputs by name
%      setOutput       - Set a digital output
%      setAnalogOutput - Set an analog output
%      relocalize      - Set the pose of the odometry
%      record          - Collect the statuses of the next seconds as columns
%      log             - Return or write all statuses since the last log
%      listen          - Call a function for each status of a service, or each event
%      subscribe       - Set how often a service sends its status
%      unsubscribe     - End the statuses of a service
%      serviceLink     - Quality of the link for one service
%      close           - End the subscriptions, and delete the object
%
%   Robot properties:
%      status          - Latest values of everything and their ages: a scalar struct
%      pose            - [x_m y_m theta_rad made_s] of the odometry, inaccurate after turns
%      speeds          - [current_linear_m_s current_angular_rad_s] of the wheels
%      info            - Limits, sensors and services of the robot: a scalar struct
%      link            - Quality of the link: a scalar struct
%      address         - Address and port
%      time_s          - Seconds since the robot was connected
%      start_utc_s     - UTC when time_s was 0, in seconds since 1970
%   pose and speeds are NaN when they are older than fresh_ms (300); the made_s of pose is when
%   the robot made it. What is not known is NaN, or 255 in a uint8.
%   The fields of the structs, which are:
%      status: time_s                  seconds since the robot was connected
%              ready, armed            the robot answers; drive is accepted
%              driving, stopping       a lease is active; the stop sequence runs
%              lapsed                  the last lease expired, and no drive, arm, pause or stop
%                                      came since
%              stop_outcome            of the last stop sequence: 'none', 'running', 'confirmed' (by
%                                      the robot), 'timed_out', 'overridden' ([A] was held)
%              disarm_cause, disarm_text   why it is not armed: one of roburoc4.Result; a sentence
%              overridden              [A] on the game pad is held
%              other_commander         another client commands the robot
%              inhibited               the robot does not follow its commands
%              front_bumper, rear_bumper, battery_low   pressed; below minimum_percent, or critical
%              missing                 services that send nothing, such as 'telemeter battery'
%              x_m, y_m, theta_rad     odometry
%              localization_flags      bits of roburoc4.LocalizationFlag; all set while unknown
%              target_linear_m_s, target_angular_rad_s     commanded speeds
%              current_linear_m_s, current_angular_rad_s   measured speeds
%              distances_m             of the telemeters, a row: on a RobuROC4 front, then rear
%              battery_state, remaining_percent   one of roburoc4.BatteryState; 0 to 100
%              iocard_age_s, localization_age_s, differential_age_s, telemeter_age_s, battery_age_s
%                                      how old the last status can be at most, Inf without one; [A]
%                                      and bumpers are of the IO card, speeds of the differential
%              robot_cycles            the robot's clock in the latest status, 10 ms each
%      info:   max_linear_m_s, min_linear_m_s, max_angular_rad_s, min_angular_rad_s,
%              max_linear_m_s2, min_linear_m_s2, max_angular_rad_s2, min_angular_rad_s2
%                                      limits of the robot's speeds and accelerations
%              width_m                 between its wheels, left to right
%              nominal_voltage_v, capacity_ah, minimum_percent   of the battery
%              power_on_x_m, power_on_y_m, power_on_theta_rad    where the odometry started
%              analog_inputs, analog_outputs, digital_inputs, digital_outputs   how many there are
%              telemeter_x_m, telemeter_y_m, telemeter_theta_rad, telemeter_field_of_view_rad,
%              telemeter_min_distance_m, telemeter_max_distance_m   rows, a number per telemeter
%              service_ids, service_types   the robot's directory, rows
%      link:   round_trip_s, round_trip_min_s   of answered requests, smoothed; 0 before the first
%              silence_s               since the last datagram that was used
%              received, lost, loss    statuses of all services; the share lost recently, 0 to 1
%
%   Example:
%      r = roburoc4.Robot('192.168.0.2', 'max_linear_m_s', 0.5);
%      r.arm();
%      r.driveFor(0.3, 0, 2);
%      s = r.status;
%      fprintf('x %.2f m, y %.2f m\n', s.x_m, s.y_m);
%      delete(r)
%
%   See also roburoc4.Simulator, roburoc4.Rate.

% SPDX-License-Identifier: MIT

properties (SetAccess = private, Hidden, Transient)
    id = 0
    listeners = roburoc4.internal.Listeners(0)     % of an object that was saved and loaded
end

properties (Dependent, SetAccess = private)
    status
    pose
    speeds
    info
    link
    address
    time_s
    start_utc_s
end

methods
    function this = Robot(address, varargin)
        %ROBOT Connect, and wait until the robot is ready.
        %   See the help of the class.
        roburoc4.internal.needed(nargin > 0, 'Robot(address), such as Robot(''192.168.0.2'')');
        own = struct('timeout', 10, 'buffer', 10000, 'record', '', 'wait_for_data', true);
        [options, own] = roburoc4.internal.options(varargin, own, false);
        timeout = roburoc4.internal.number(own.timeout, 'timeout', 0, 1e6);
        patient = roburoc4.internal.number(own.wait_for_data, 'wait_for_data', 0, 1) ~= 0;
        own.record = roburoc4.Robot.capture(own.record);
        if isa(address, 'roburoc4.Simulator')
            this.id = roburoc4_mex('simConnect', address.id, options, own.buffer, own.record);
        else
            address = roburoc4.internal.text(address, 'address');
            this.id = roburoc4_mex('open', address, options, own.buffer, own.record);
        end
        this.listeners = roburoc4.internal.Listeners(this.id);
        try
            roburoc4.internal.connect(this.id, timeout, patient);
        catch problem
            roburoc4_mex('close', this.id);
            rethrow(problem);
        end
    end

    function delete(this)
        %DELETE Stop the robot if R drives it, end the subscriptions, and close the link.
        %   delete(R) waits until the robot has confirmed the stop, at most for the robot's watchdog
        %   time, and 0.3 s for the subscriptions. They stay if somebody else drives the robot: some
        %   robots have one list for all programs, whose statuses would end, too. Later calls with R
        %   raise roburoc4:closed; a second delete does nothing.
        %
        %   Example:
        %      delete(r)
        id = this.id;
        cleanup = onCleanup(@() roburoc4_mex('close', id)); %#ok<NASGU>
        try
            this.stop_driving();
            this.end_subscriptions();
        catch
            % Its simulator was deleted, or the program ends: then the MEX file stops all robots.
        end
    end

    function close(this)
        %CLOSE As delete(R), but raise roburoc4:closed if R is closed.
        %
        %   Example:
        %      close(r)
        roburoc4_mex('status', this.id);
        delete(this);
    end

    function disp(this)
        %DISP Show the address and the state.
        %
        %   Example:
        %      disp(r)
        try
            s = this.status;
            states = {'not ready', 'ready'; 'disarmed', 'armed'};
            fprintf('  roburoc4.Robot at %s, %s, %s\n', this.address, states{1, 1 + s.ready}, ...
                states{2, 1 + s.armed});
        catch
            fprintf('  roburoc4.Robot, deleted\n');
        end
    end

    function drive(this, linear_m_s, angular_rad_s)
        %DRIVE Drive at these speeds for one lease; call it repeatedly to keep driving.
        %   drive(R, V, W) sends the speeds V in m/s and W in rad/s at once and returns. They are
        %   scaled, and limited by the robot and by the options; more than 5 m/s or 10 rad/s is
        %   refused as a mistake of units. After lease_ms without another call the robot is stopped,
        %   and lapse_disarm_ms later it is disarmed. Raises roburoc4:notArmed with the reason if
        %   driving is not allowed.
        %
        %   Example:
        %      r.drive(0.3, 0.1)
        if nargin < 3
            roburoc4.internal.needed(false, 'drive(v in m/s, w in rad/s)');
        end
        roburoc4_mex('drive', this.id, linear_m_s, angular_rad_s);
    end

    function driveFor(this, linear_m_s, angular_rad_s, seconds)
        %DRIVEFOR Drive at these speeds for some seconds, and stop.
        %   driveFor(R, V, W, SECONDS) renews the command and returns at the end; the robot stays
        %   armed. Ctrl-C or an error stops the robot at once, as stop does; so do [A] on the game
        %   pad, a robot that does not follow (emergency stop, brakes), and a program that hung in
        %   the middle, with the error roburoc4:notArmed.
        %
        %   Example:
        %      r.driveFor(0.5, 0, 2)
        roburoc4.internal.needed(nargin == 4, 'driveFor(v in m/s, w in rad/s, seconds)');
        seconds = roburoc4.internal.number(seconds, 'seconds', 0, 1e6);
        cleanup = roburoc4.internal.guard(this.id); %#ok<NASGU>
        left_s = seconds;
        finish_s = this.time_s + seconds;
        command = 'drive';
        while left_s > 0
            lease_s = roburoc4_mex(command, this.id, linear_m_s, angular_rad_s);
            now_s = this.listeners.wait(min([left_s lease_s / 4, 0.05]));
            left_s = finish_s - now_s;
            command = 'renew';
        end
        if seconds > 0
            roburoc4_mex('pause', this.id);
        end
        roburoc4_mex('busy', this.id, false);
    end

    function result = move(this, distance_m, varargin)
        %MOVE Drive straight ahead, and wait until the robot is at rest.
        %   RESULT = move(R, METRES) drives this far by odometry; negative is backward. RESULT is a
        %   struct: outcome ('reached'), distance_m, angle_rad, remaining_m, remaining_rad, and text, the
        %   outcome as a sentence.
        %   move(R, METRES, 'Name', value, ...) takes options:
        %
        %      speed (0.3)       m/s, within the ceilings max_linear_m_s and max_angular_rad_s
        %      clearance (0.5)   metres to keep from what telemeters see in the direction of
        %                        travel, in addition to the braking distance. It needs telemeters
        %                        and bumpers that are known; 0 drives without them. Telemeters
        %                        miss things
        %      timeout           seconds; by default twice what its profile takes, plus 3
        %
        %   Raises roburoc4:moveEnded with the reason if it does not reach its goal: a pressed
        %   bumper, something in the way, the game pad, an emergency stop, a lost link. The robot may
        %   still roll then: call rest. It stays armed. Ctrl-C or an error stops the robot at once,
        %   as stop does.
        %
        %   Example:
        %      r.move(1); r.turn(pi / 2); r.move(0.5, 'speed', 0.6)
        roburoc4.internal.needed(nargin >= 2, 'move(metres)');
        result = this.go(0, distance_m, 0, 0, varargin);
    end

    function result = moveFor(this, linear_m_s, angular_rad_s, seconds, varargin)
        %MOVEFOR Drive for some seconds with gentle ramps, and wait until the robot is at rest.
        %   RESULT = moveFor(R, V, W, SECONDS) drives at these speeds, ramps included, however far
        %   that is. Options and result are those of move, without speed.
        %
        %   Example:
        %      r.moveFor(0.3, 0, 2)
        roburoc4.internal.needed(nargin >= 4, 'moveFor(v in m/s, w in rad/s, seconds)');
        linear_m_s = roburoc4.internal.number(linear_m_s, 'linear_m_s', -1e6, 1e6);
        angular_rad_s = roburoc4.internal.number(angular_rad_s, 'angular_rad_s', -1e6, 1e6);
        seconds = roburoc4.internal.number(seconds, 'seconds', 0, 1e4);
        result = this.go(4, linear_m_s, angular_rad_s, seconds, varargin);
    end

    function result = turn(this, angle_rad, varargin)
        %TURN Turn in place, and wait until the robot is at rest.
        %   RESULT = turn(R, RADIANS) turns by odometry, which is inaccurate; negative is to the
        %   right. More than two turns must be meant, with the option allow_turns: degrees look
        %   like that. Options and result are those of move; speed is in rad/s (0.5), and telemeters
        %   are not used.
        %
        %   Example:
        %      r.turn(pi / 2)
        roburoc4.internal.needed(nargin >= 2, 'turn(radians)');
        angle_rad = roburoc4.internal.number(angle_rad, 'angle', -1e9, 1e9);
        result = this.go(0, 0, angle_rad, 0, varargin);
    end

    function result = arc(this, distance_m, angle_rad, varargin)
        %ARC Drive along an arc, and wait until the robot is at rest.
        %   RESULT = arc(R, METRES, RADIANS) drives this far while it turns by the angle. Options
        %   and result are those of move.
        %
        %   Example:
        %      r.arc(1, pi / 2)
        roburoc4.internal.needed(nargin >= 3, 'arc(metres, radians)');
        result = this.go(0, distance_m, angle_rad, 0, varargin);
    end

    function result = goTo(this, x_m, y_m, varargin)
        %GOTO Turn to a point and drive there, and wait until the robot is at rest.
        %   RESULT = goTo(R, X, Y) goes to a point in the frame of pose. goTo(R, X, Y, THETA)
        %   turns to that heading at the end. Options and result are those of move.
        %
        %   Example:
        %      r.goTo(1, 0.5); r.goTo(0, 0, 0, 'speed', 0.6)
        roburoc4.internal.needed(nargin >= 3, 'goTo(x in m, y in m)');
        if mod(numel(varargin), 2) == 1
            theta_rad = roburoc4.Robot.radians(varargin{1}, 'theta');
            result = this.go(2, x_m, y_m, theta_rad, varargin(2:end));
        else
            result = this.go(1, x_m, y_m, 0, varargin);
        end
    end

    function result = rest(this, varargin)
        %REST Stop, and wait until the robot is at rest, armed or not.
        %   rest(R, 'timeout', SECONDS) waits at most this long (5). stop does not wait.
        %
        %   Example:
        %      r.driveFor(0.5, 0, 2); r.rest()
        result = this.go(3, 0, 0, 0, varargin);
    end

    function stop(this)
        %STOP Stop the robot and disarm it. Never waits.
        %   stop(R) ends the drive command and sends the stop sequence, armed or not. drive is then
        %   refused until arm is called. status.stop_outcome tells whether the robot confirmed it.
        %
        %   Example:
        %      r.stop()
        roburoc4_mex('stop', this.id);
    end

    function pause(this)
        %PAUSE Stop the robot and stay armed. Never waits.
        %   pause(R) does what stop does, but drive is accepted afterwards. It is for a program's own
        %   end of driving; a stop button calls stop.
        %
        %   Example:
        %      r.pause()
        roburoc4_mex('pause', this.id);
    end

    function arm(this, timeout)
        %ARM Allow driving.
        %   arm(R) raises roburoc4:notArmed with the reason if it is refused. It waits for 10 seconds,
        %   or arm(R, SECONDS), if the reason can go away by itself: no status yet, the robot still
        %   rolls.
        %
        %   Example:
        %      r.arm()
        if nargin < 2
            timeout = 10;
        end
        timeout = roburoc4.internal.number(timeout, 'timeout', 0, 1e6);
        finish_s = this.time_s + timeout;
        while ~roburoc4_mex('arm', this.id, this.time_s >= finish_s)
            this.sleep(0.02);
        end
    end

    function sleep(this, seconds)
        %SLEEP Wait, in slices short enough for Ctrl-C.
        %   sleep(R, SECONDS) returns after this time. It renews nothing: a drive command ends
        %   with its lease. Ctrl-C stops a robot that R drives at once. With a robot in virtual time,
        %   virtual time passes.
        %
        %   Example:
        %      r.drive(0.3, 0); r.sleep(0.2)
        roburoc4.internal.needed(nargin == 2, 'sleep(seconds)');
        seconds = roburoc4.internal.number(seconds, 'seconds', 0, 1e6);
        this.listeners.sleep(seconds);
    end

    function loop = rate(this, hertz)
        %RATE Make a loop with a fixed rate, without a timer.
        %   LOOP = rate(R, HERTZ) makes a roburoc4.Rate; its wait() ends at the next tick.
        %
        %   Example:
        %      loop = r.rate(20);
        %      while loop.time_s < 5
        %          r.drive(0.3, 0.2 * sin(loop.time_s));
        %          loop.wait();
        %      end
        roburoc4.internal.needed(nargin == 2, 'rate(hertz)');
        loop = roburoc4.Rate(this, hertz);
    end

    function s = get.status(this)
        s = roburoc4_mex('status', this.id);
    end

    function row = get.pose(this)
        row = roburoc4_mex('pose', this.id);
    end

    function row = get.speeds(this)
        row = roburoc4_mex('speeds', this.id);
    end

    function s = get.info(this)
        s = roburoc4_mex('info', this.id);
    end

    function s = get.link(this)
        s = roburoc4_mex('link', this.id);
    end

    function s = get.address(this)
        progress = roburoc4_mex('progress', this.id);
        s = progress.address;
    end

    function s = get.time_s(this)
        s = roburoc4_mex('now', this.id);
    end

    function s = get.start_utc_s(this)
        s = roburoc4_mex('startUtc', this.id);
    end

    function s = serviceLink(this, service)
        %SERVICELINK Quality of the link for one service: period, jitter, age, loss.
        %   S = serviceLink(R, SERVICE) with 'iocard', 'telemeter', 'battery', 'localization' or
        %   'differential' is a scalar struct; its times are in seconds, loss is 0 to 1.
        %
        %   Example:
        %      s = r.serviceLink('localization'); s.period_s
        roburoc4.internal.needed(nargin == 2, 'serviceLink(service)');
        service = roburoc4.internal.text(service, 'service');
        s = roburoc4_mex('serviceLink', this.id, service);
    end

    function value = inputs(this, name)
        %INPUTS Read inputs of the IO card by name.
        %   VALUE = inputs(R, NAME) is logical for a digital input, and a double, generally volts, for
        %   an analog one. NAME is the robot's name of the input, or the manual's (5.5.1) if the robot
        %   does not name it; case, punctuation and word order do not matter. S = inputs(R) is a
        %   scalar struct of all inputs, by their index in the protocol, and of the names of all
        %   channels. These are the latest values; age_s of the struct is how old they can be.
        %
        %   Example:
        %      r.inputs('Front bumper')
        %      r.inputs('Battery voltage')
        if nargin < 2
            value = roburoc4_mex('inputs', this.id);
            names = roburoc4_mex('names', this.id);
            for kind = fieldnames(names)'
                value.(kind{1}) = names.(kind{1});
            end
            return
        end
        name = roburoc4.internal.text(name, 'name of an input');
        at = roburoc4_mex('channel', this.id, name, 1 + 4); % analog and digital inputs
        s = roburoc4_mex('inputs', this.id);
        values = s.digital_inputs;
        if at(1) == 0
            values = s.analog_inputs;
        end
        if at(2) >= numel(values)
            error('roburoc4:limit', 'input %d is beyond those that the client stores', at(2));
        end
        value = values(at(2) + 1);
    end

    function setOutput(this, channel, on)
        %SETOUTPUT Set a digital output.
        %   setOutput(R, CHANNEL, ON) takes the index in the protocol (from 0) or a name. Each command
        %   sets all outputs: those that were never set are sent as off. Output 0 belongs to the
        %   robot and is refused.
        %
        %   Example:
        %      r.setOutput(3, true)
        roburoc4.internal.needed(nargin == 3, 'setOutput(index or name, true or false)');
        roburoc4_mex('digital', this.id, this.output(channel, 8), on);
    end

    function setAnalogOutput(this, channel, volts)
        %SETANALOGOUTPUT Set an analog output, generally in volts. A RobuROC4 has none.
        %
        %   Example:
        %      r.setAnalogOutput(0, 2.5)
        roburoc4.internal.needed(nargin == 3, 'setAnalogOutput(index or name, volts)');
        roburoc4_mex('analog', this.id, this.output(channel, 2), volts);
    end

    function relocalize(this, x_m, y_m, theta_rad)
        %RELOCALIZE Set the pose of the robot's odometry, and wait until the robot reports it.
        %   relocalize(R, X, Y, THETA) takes metres and radians. Raises roburoc4:protocol if the robot
        %   refuses, roburoc4:timeout if it does not answer within 2 seconds, or sends no pose in the
        %   3 seconds after its answer. The robot need not be armed.
        %
        %   Example:
        %      r.relocalize(0, 0, 0)
        roburoc4.internal.needed(nargin == 4, 'relocalize(x in m, y in m, theta in rad)');
        roburoc4_mex('relocalize', this.id, x_m, y_m, theta_rad);
        while ~roburoc4_mex('relocalized', this.id)
            this.sleep(0.01);
        end
        answered_s = this.time_s;
        s = this.status;
        subscribed = this.serviceLink('localization').subscribed;
        while subscribed && s.time_s - s.localization_age_s <= answered_s
            if s.time_s > answered_s + 3
                error('roburoc4:timeout', ['relocalize: the robot accepted the pose, but has not ' ...
                    'reported it within 3 s; check link']);
            end
            this.sleep(0.01);
            s = this.status;
        end
    end

    function subscribe(this, service, period_ms)
        %SUBSCRIBE Set how often a service sends its status.
        %   subscribe(R, SERVICE, PERIOD_MS) takes a multiple of 10, 10 to 2550. If the robot is away,
        %   the request is sent when it answers again.
        %
        %   Example:
        %      r.subscribe('localization', 20)
        roburoc4.internal.needed(nargin == 3, 'subscribe(service, period_ms)');
        service = roburoc4.internal.text(service, 'service');
        period_ms = roburoc4.internal.number(period_ms, 'period_ms', 10, 2550);
        if mod(period_ms, 10) ~= 0
            error('roburoc4:badArgument', ['period_ms: %g is not allowed; give a multiple of 10, ' ...
                '10 to 2550'], period_ms);
        end
        roburoc4_mex('subscribe', this.id, service, period_ms);
    end

    function unsubscribe(this, service)
        %UNSUBSCRIBE End the statuses of a service.
        %
        %   Example:
        %      r.unsubscribe('telemeter')
        roburoc4.internal.needed(nargin == 2, 'unsubscribe(service)');
        service = roburoc4.internal.text(service, 'service');
        roburoc4_mex('subscribe', this.id, service, 0);
    end

    function s = receive(this, service, timeout)
        %RECEIVE Wait for the next status of a service.
        %   S = receive(R, SERVICE, SECONDS) is a scalar struct of the first status that arrives after
        %   this call: its values, time_s when it arrived, utc_s when the robot made it, and
        %   robot_cycles. It waits for at most this long (1), and does not renew a drive command. Raises
        %   roburoc4:timeout if none arrived.
        %
        %   Example:
        %      s = r.receive('localization', 1); s.x_m
        roburoc4.internal.needed(nargin >= 2, 'receive(service, seconds)');
        service = roburoc4.internal.text(service, 'service');
        if nargin < 3
            timeout = 1;
        end
        timeout = roburoc4.internal.number(timeout, 'timeout', 0, 1e6);
        cleanup = roburoc4.internal.guard(this.id); %#ok<NASGU>
        roburoc4_mex('listen', this.id);
        finish_s = this.time_s + timeout;
        left_s = timeout;
        s = [];
        while isempty(s) && left_s >= 0
            this.listeners.wait(0);
            s = roburoc4_mex('receive', this.id, service, min(left_s, 0.05));
            left_s = finish_s - this.time_s - 1e-6;
        end
        if isempty(s)
            error('roburoc4:timeout', ['no status of the service %s within %g s; check link, and ' ...
                'its period (subscribe)'], service, timeout);
        end
        roburoc4_mex('busy', this.id, false);
    end

    function listen(this, kind, action)
        %LISTEN Call a function for each status of a service, or for each event.
        %   listen(R, SERVICE, ACTION) calls ACTION(S) with the struct that receive returns, for each
        %   status that arrives from now on. listen(R, 'event', ACTION) calls it with a struct of name,
        %   text and time_s; names are ready, lost, reboot, armed, disarmed, lapsed, stop_confirmed,
        %   stop_unconfirmed, override, other_commander, inhibited, battery_low, battery_critical and
        %   armable. listen(R, KIND, []) ends that.
        %
        %   ACTION is called while a method of R or of its rates waits, as sleep, move and loop.wait do,
        %   never in between. It must be short, and may call what does not wait, such as stop: an
        %   error in it ends the waiting method, and stops a robot that R drives. In Octave, an ACTION
        %   that has R itself keeps R from being deleted by clear: call delete(R).
        %
        %   Example:
        %      r.listen('event', @(e) fprintf('%.1f s: %s\n', e.time_s, e.text));
        %      r.listen('battery', @(s) fprintf('%d %%\n', s.remaining_percent));
        %      r.sleep(5);
        roburoc4.internal.needed(nargin == 3, 'listen(service or ''event'', function)');
        kind = roburoc4.internal.text(kind, 'service');
        if ~strcmp(kind, 'event')
            this.serviceLink(kind);
        end
        if ~isempty(action) && ~isa(action, 'function_handle')
            error('roburoc4:badArgument', ['action: this is %s; give a function, such as @disp, or [] ' ...
                'to end listening'], roburoc4.internal.kind(action));
        end
        this.listeners.set(kind, action);
    end

    function data = record(this, seconds, varargin)
        %RECORD Collect the statuses of the next seconds, as columns ready to plot.
        %   DATA = record(R, SECONDS) is a struct with a struct of columns for each service: iocard,
        %   telemeter, battery, localization, differential. All have time_s, when a status arrived, in
        %   seconds from now; utc_s, when the robot made it, in seconds since 1970 by this machine's
        %   clock; and robot_cycles, uint64 counts of 10 ms. DATA.start_utc_s is UTC when time_s was
        %   0, DATA.lost the number of statuses that were overwritten before they were read.
        %   record(R, SECONDS, SERVICE, ...) collects only these services. It does not renew a drive
        %   command. Raises roburoc4:timeout if nothing arrived because the robot does not answer.
        %
        %   In MATLAB the columns of a service are a timetable with the same variables, whose row times
        %   are utc_s.
        %
        %   Example:
        %      data = r.record(2, 'localization');
        %      plot(data.localization.time_s, data.localization.x_m)
        roburoc4.internal.needed(nargin >= 2, 'record(seconds)');
        seconds = roburoc4.internal.number(seconds, 'seconds', 0, 1e6);
        services = roburoc4.Robot.texts(varargin);
        cleanup = roburoc4.internal.guard(this.id); %#ok<NASGU>
        roburoc4_mex('record', this.id, services{:});
        finish_s = this.time_s + seconds;
        left_s = seconds;
        while left_s > 0
            left_s = finish_s - this.listeners.wait(min(left_s, 0.05));
            roburoc4_mex('recorded', this.id);
        end
        data = roburoc4.Robot.timetables(roburoc4_mex('recording', this.id, services{:}));
        roburoc4_mex('busy', this.id, false);
    end

    function data = log(this, file, varargin)
        %LOG Return all statuses since the last log, or write them to a MAT-file.
        %   DATA = log(R) has what arrived since R was made, or since the last log, with the fields of
        %   record; time_s counts from when R was made. log(R, FILE) writes it to a MAT-file, as structs
        %   that both programs read: roburoc4.asTimetable makes timetables of them. To log
        %   one drive, call log(R) before it and log(R, FILE) after it. log(R, FILE, SERVICE, ...) has
        %   only these services; with '' as FILE nothing is written. The option buffer says how many
        %   statuses are kept; if it is too small, the oldest are lost, and a warning says how many.
        %   If the disk is full there is an error, an existing file stays as it was, and no status is
        %   lost.
        %
        %   Example:
        %      r.log();
        %      r.driveFor(0.3, 0, 2);
        %      r.log('drive.mat');
        %      data = load('drive.mat');
        if nargin < 2
            file = '';
        elseif ~isequal(file, '')
            file = roburoc4.internal.text(file, 'file');
        end
        services = roburoc4.Robot.texts(varargin);
        data = roburoc4_mex('log', this.id, services{:});
        if ~isempty(file)
            roburoc4.internal.write(file, data);
        end
        roburoc4_mex('logged', this.id);
        if data.lost > 0 && (nargout > 0 || ~isempty(file))
            warning('roburoc4:limit', ['%d statuses were overwritten before log was called. Call ' ...
                'it more often, or give roburoc4.Robot a larger buffer'], data.lost);
        end
        if nargout > 0
            data = roburoc4.Robot.timetables(data);
        else
            clear data;                    % otherwise all of it would be printed without a semicolon
        end
    end
end

methods (Access = private)
    function stop_driving(this)
        while roburoc4_mex('leave', this.id)
            roburoc4_mex('wait', this.id, 0.02);
        end
    end

    function end_subscriptions(this)
        s = this.status;
        if s.other_commander || any([s.target_linear_m_s, s.target_angular_rad_s] ~= 0)
            return
        end
        for service = {'iocard', 'telemeter', 'battery', 'localization', 'differential'}
            this.unsubscribe(service{1});
        end
        finish_s = this.time_s + 0.3;      % a request that was lost is repeated after 0.1 s
        while this.time_s < finish_s
            roburoc4_mex('wait', this.id, 0.05);
        end
    end

    function result = go(this, kind, x, y, theta, given)
        [~, own] = roburoc4.internal.options(given, ...
            struct('speed', [], 'clearance', -1, 'timeout', 0, 'allow_turns', false));
        speed = 0;
        if kind == 4 && ~isempty(own.speed)
            error('roburoc4:badArgument', 'speed: moveFor has its own');
        end
        if ~isempty(own.speed)
            speed = roburoc4.internal.number(own.speed, 'speed', 0.001, 10);
        end
        if ~isequal(own.clearance, -1) || any(strcmpi(given(1:2:end), 'clearance'))
            own.clearance = roburoc4.internal.number(own.clearance, 'clearance', 0, 100);
        end
        timeout = roburoc4.internal.number(own.timeout, 'timeout', 0, 4e6);
        cleanup = roburoc4.internal.guard(this.id); %#ok<NASGU>
        roburoc4_mex('moveBegin', this.id, kind, x, y, theta, speed, ...
            own.clearance, timeout, ...
            roburoc4.internal.number(own.allow_turns, 'allow_turns', 0, 1));
        while roburoc4_mex('moveStep', this.id)
            this.listeners.wait(0.02);
        end
        result = roburoc4_mex('moveResult', this.id);
        roburoc4_mex('busy', this.id, false);
        if ~strcmp(result.outcome, 'reached')
            error('roburoc4:moveEnded', '%s after %.2f m and %.2f rad: %s', result.outcome, ...
                result.distance_m, result.angle_rad, result.text);
        end
    end

    function index = output(this, channel, type)
        index = channel;
        if ~isnumeric(channel)
            channel = roburoc4.internal.text(channel, 'channel');
            at = roburoc4_mex('channel', this.id, channel, type);
            index = at(2);
        end
    end
end

methods (Static, Access = private)
    function file = capture(file)
        % A capture that is named after something else is not found again.
        if isequal(file, '')
            return
        end
        file = roburoc4.internal.text(file, 'record');
        if exist(file, 'dir') ~= 7 && isempty(regexp(file, '\.pcapng$', 'once'))
            error('roburoc4:badArgument', ['record: ''%s'' cannot be used; give a name that ends in ' ...
                '.pcapng, or a folder that exists'], file);
        end
    end

    function angle_rad = radians(angle_rad, name)
        angle_rad = roburoc4.internal.number(angle_rad, name, -1e9, 1e9);
        if abs(angle_rad) > 2 * pi + 0.01
            error('roburoc4:badArgument', ['%s: %g is more than one turn; give radians, such as ' ...
                'pi / 2 for 90 degrees'], name, angle_rad);
        end
    end

    function data = timetables(data)
        services = {'iocard', 'telemeter', 'battery', 'localization', 'differential'};
        for k = 1:numel(services)
            if isfield(data, services{k})
                data.(services{k}) = roburoc4.asTimetable(data.(services{k}));
            end
        end
    end

    function names = texts(names)
        for k = 1:numel(names)
            names{k} = roburoc4.internal.text(names{k}, 'service');
        end
    end
end
end
