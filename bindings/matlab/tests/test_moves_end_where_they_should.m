function test_moves_end_where_they_should()
% Moves in virtual time: their ends, their results and their errors.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('slip', 0);
sim.clearObstacles();
r = sim.connect();
check_raises('roburoc4:notArmed', @() r.move(1));
r.arm();
result = r.move(1);
check(strcmp(result.outcome, 'reached'), '%s', result.outcome);
check(abs(result.distance_m - 1) < 0.01 && abs(result.remaining_m) < 0.01, 'came %g', result.distance_m);
check(abs(sim.state.true_x_m - 1) < 0.01, 'x %g', sim.state.true_x_m);
result = r.turn(pi / 2, 'speed', 1);
check(abs(result.angle_rad - pi / 2) < 0.0175, 'turned %g', result.angle_rad);
check(abs(sim.state.true_theta_rad - pi / 2) < 0.0175, 'theta %g', sim.state.true_theta_rad);
r.goTo(0, 1);
check(abs(sim.state.true_x_m) < 0.02 && abs(sim.state.true_y_m - 1) < 0.02, 'not at 0 1');
r.goTo(0, 0, 1, 'speed', 0.6);
check(abs(sim.state.true_theta_rad - 1) < 0.0175, 'theta %g', sim.state.true_theta_rad);
began_s = r.time_s;
r.arc(0.5, -0.5, 'speed', 0.1);
check(r.time_s - began_s > 5, 'half a metre at 0.1 m/s took %g s', r.time_s - began_s);

result = r.moveFor(-0.2, 0, 3);
check(strcmp(result.outcome, 'reached') && abs(result.distance_m + 0.5) < 0.1, 'came %g', result.distance_m);
result = r.turn(13, 'speed', 1.5, 'allow_turns', true);
check(abs(result.angle_rad - 13) < 0.03, 'turned %g', result.angle_rad);
check_raises('roburoc4:badArgument', @() r.turn(13));
r.arm();

r.driveFor(0.8, 0, 2);
check(abs(r.speeds(1)) > 0.3, 'it does not roll');
r.stop();
check_raises('roburoc4:notArmed', @() r.arm(0));   % it rolls
r.arm();
r.rest();
check(abs(r.speeds(1)) < 0.02, 'it rolls with %g', r.speeds(1));

% What ends a move is an error, and says so.
began_s = r.time_s;
check_raises('roburoc4:moveEnded', @() r.move(5, 'timeout', 1));
check(abs(r.time_s - began_s - 2) <= 1, 'a second became %g s', r.time_s - began_s);
r.rest();
sim.set('pad_a', true);
sim.step(0.2);
check_raises('roburoc4:notArmed', @() r.move(1));
sim.set('pad_a', false);
r.sleep(1);
r.arm();
check_raises('roburoc4:badArgument', @() r.move(NaN));
check_raises('roburoc4:badArgument', @() r.move(1e6));
check_raises('roburoc4:badArgument', @() r.move(1, 'speed', 0));
check_raises('roburoc4:badArgument', @() r.move(1, 'speed', 50));
check_raises('roburoc4:badArgument', @() r.arc(1, 90));
check_raises('roburoc4:moveEnded', @() r.move(1, 'speed', 1.1));
result = roburoc4_mex('moveResult', r.id);
check(strcmp(result.outcome, 'too_fast'), '%s', result.outcome);
check_raises('roburoc4:badArgument', @() r.move(1, 'clearance', -1));
check_raises('roburoc4:badArgument', @() r.move(1, 'haste', 1));
check_raises('roburoc4:badArgument', @() r.move());
check_raises('roburoc4:badArgument', @() r.goTo(1));

% It stands at an obstacle, unless a smaller clearance lets it through.
delete(r);
delete(sim);
sim = roburoc4.Simulator();
r = sim.connect();
r.arm();
check_raises('roburoc4:moveEnded', @() r.move(0.5, 'clearance', 20));
result = roburoc4_mex('moveResult', r.id);
check(strcmp(result.outcome, 'obstacle'), '%s', result.outcome);
result = r.move(0.5, 'clearance', 0.1);
check(strcmp(result.outcome, 'reached'), '%s', result.outcome);
delete(r);
delete(sim);
end
