function test_inputs_and_outputs()
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator('port', 0);
r = sim.connect();
begun = tic();
while r.status.robot_cycles < 10 && toc(begun) < 60
    r.sleep(0.05);
end
names = r.inputs();
names = names.digital_input_names;
check(strcmpi(names{1}, 'Front bumper') && numel(names) == 22, 'names');
check(islogical(r.inputs('front bumper')) && ~r.inputs('Front bumper'), 'bumper');
check(isa(r.inputs('Battery voltage'), 'double') && r.inputs('battery voltage') > 20, 'voltage');
sim.set('front_bumper', true);
wait_for(r, @() r.inputs('Front bumper'));
check(r.status.front_bumper, 'status does not show the bumper');
sim.panel('pin analog 2 12.5');
wait_for(r, @() r.inputs('Battery voltage') == 12.5);
r.setOutput(3, true);
wait_for(r, @() sim.get('digital_output_3'));
check(~sim.get('digital_output_2'), 'another output changed');
check_raises('roburoc4:badArgument', @() r.setAnalogOutput('Watchdog', 1));
r.setOutput(3, false);
wait_for(r, @() ~sim.get('digital_output_3'));
for k = 1:5
    r.relocalize(k, -2, 0.5);
    check(norm(r.pose(1:3) - [k -2 0.5]) < 1e-9, 'relocalize returned before the pose was new');
end
r.unsubscribe('localization');
r.relocalize(1, -2, 0.5); % nobody waits for a pose that was not asked for
r.subscribe('localization', 50);
sim.set('battery_percent', 10);
wait_for(r, @() r.status.battery_low == 1);
sim.set('estop_local', true);
wait_for(r, @() ~sim.state.motors_enabled);
sim.set('estop_local', false);
sim.set('motor_button', true);
check(sim.state.motors_enabled, 'motor button');
sim.set('power', false);
wait_for(r, @() ~r.status.ready);

% A robot that is away: its remedy is not to arm.
away = {@() r.setOutput(3, true), @() r.relocalize(0, 0, 0)};
for k = 1:numel(away)
    check_raises('roburoc4:timeout', away{k});
    try
        away{k}();
    catch problem
        check(isempty(strfind(problem.message, 'arm')), '%s', problem.message);
    end
end
delete(r);
delete(sim);
end

function wait_for(r, condition)
begun = tic();
while ~condition()
    check(toc(begun) < 60, 'not within a minute: %s', func2str(condition));
    r.sleep(0.02);
end
end
