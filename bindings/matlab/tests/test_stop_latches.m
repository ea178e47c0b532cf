function test_stop_latches()
% After stop nothing drives until arm; after pause, moves and driveFor it may; a lease that expired
% ends what it belonged to, and disarms a second later.
% SPDX-License-Identifier: MIT
sim = roburoc4.Simulator();
r = sim.connect();
r.arm();
check(isempty(r.status.disarm_text) && r.status.disarm_cause == roburoc4.Result.OK, 'armed');
check(strcmp(r.status.stop_outcome, 'none'), 'no stop was sent yet');
r.drive(0.3, 0);
r.sleep(0.1);
r.stop();
check(r.status.stopping && strcmp(r.status.stop_outcome, 'running'), 'the stop sequence runs');
check_raises('roburoc4:notArmed', @() r.drive(0.3, 0));
check(r.status.disarm_cause == roburoc4.Result.STOP_CALLED, 'the cause');
check(~isempty(strfind(r.status.disarm_text, 'arm()')), '%s', r.status.disarm_text);
check_raises('roburoc4:notArmed', @() r.driveFor(0.3, 0, 1));
check_raises('roburoc4:notArmed', @() r.move(0.1));
r.sleep(3);
check(strcmp(r.status.stop_outcome, 'confirmed'), 'confirmed: %s', r.status.stop_outcome);
check(sim.state.target_linear_m_s == 0, 'it drives on');

r.arm();
r.drive(0.3, 0);
r.sleep(0.1);
r.pause();
r.sleep(0.5);
check(r.status.armed && sim.state.target_linear_m_s == 0, 'pause stops and keeps armed');
r.drive(0.3, 0);
r.driveFor(0.3, 0, 0.5);
check(r.status.armed && ~r.status.driving, 'driveFor ends with a pause');
r.move(0.2);
check(r.status.armed, 'a move ends with a pause');

% Not renewed: stopped, and later disarmed.
r.drive(0.3, 0);
r.sleep(0.5);
check(r.status.lapsed && r.status.armed, 'the lease expired');
r.sleep(1);
check(~r.status.armed && r.status.disarm_cause == roburoc4.Result.LAPSED, 'the lapse disarms');
check_raises('roburoc4:notArmed', @() r.drive(0.3, 0));
delete(r);

% driveFor and moves do not set off again after a hang.
r = sim.connect();
r.arm();
mex = @roburoc4_mex;
mex('drive', r.id, 0.3, 0);
sim.step(0.5);
check_raises('roburoc4:notArmed', @() mex('renew', r.id, 0.3, 0));
mex('drive', r.id, 0.3, 0);
r.pause();
check_raises('roburoc4:moveEnded', @() mex('renew', r.id, 0.3, 0));
r.rest();
mex('moveBegin', r.id, 0, 2, 0, 0, 0, 0, 0, false);
for k = 1:50
    check(mex('moveStep', r.id), 'the move runs');
    sim.step(0.02);
end
sim.step(0.5);
check(~mex('moveStep', r.id), 'the move goes on after a hang');
result = mex('moveResult', r.id);
check(strcmp(result.outcome, 'lapsed'), 'the move: %s', result.outcome);
sim.step(1);
check(r.status.disarm_cause == roburoc4.Result.LAPSED, 'the lapse of a move disarms');
delete(r);

r = sim.connect('lapse_disarm_ms', 0);
r.arm();
r.drive(0.3, 0);
r.sleep(0.3);
check(~r.status.armed, 'lapse_disarm_ms 0');
delete(r);
delete(sim);
end
