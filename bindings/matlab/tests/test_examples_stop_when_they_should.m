function test_examples_stop_when_they_should()
% The examples that drive end, and leave the robot disarmed, where its motors are inhibited, where
% its pose is old, and where it takes too long.
% SPDX-License-Identifier: MIT
restored = without_display(); %#ok<NASGU>
drives = {@pure_pursuit, @speed_response};
for k = 1:numel(drives)
    sim = simulator();
    sim.set('estop_remote', true);
    stops(sim, sim.connect(), drives{k}, 'roburoc4:notArmed');

    % Statuses of the pose come too seldom: it is old before it is there again.
    sim = simulator();
    stops(sim, sim.connect('localization_period_ms', 1000), drives{k}, 'roburoc4:timeout');
    sim = simulator();
    stops(sim, sim.connect('localization_period_ms', 0), drives{k}, 'roburoc4:timeout');
end
sim = simulator();
stops(sim, sim.connect('max_linear_m_s', 0.001), @pure_pursuit, 'roburoc4:timeout');
sim = simulator();
sim.set('estop_remote', true);
stops(sim, sim.connect(), @drive_square, 'roburoc4:moveEnded');
end

function sim = simulator()
sim = roburoc4.Simulator();
sim.clearObstacles();
end

function stops(sim, robot, drive, id)
name = func2str(drive);
picture = [tempname() '.png'];
check_raises(id, @() drive(robot, picture));
check(~robot.status.armed, '%s: still armed', name);
robot.sleep(0.1);
check(sim.state.target_linear_m_s == 0 && sim.state.target_angular_rad_s == 0, '%s drives on', name);
robot.sleep(2);
sim.set('estop_remote', false);
sim.set('motor_button', true);
robot.sleep(1);
moved_m = norm([sim.state.true_x_m sim.state.true_y_m]);
check(moved_m < 1, '%s: moved %g m', name, moved_m);
check(~exist(picture, 'file'), '%s wrote a picture', name);
delete(robot);
delete(sim);
end
