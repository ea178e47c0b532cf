function connect(id, timeout, wait_for_data)
%CONNECT Wait until a robot is ready.
%   roburoc4.internal.connect(ID, TIMEOUT, WAIT_FOR_DATA) raises roburoc4:timeout after TIMEOUT seconds in which
%   nothing arrived from the robot, or in which it made no progress towards ready. With
%   WAIT_FOR_DATA it then waits for the first status of each service, but only for as long as the
%   longest period: a service that stays silent is none of the constructor's errors.
%
%   Example:
%      roburoc4.internal.connect(id, 10, true)
%
%   See also roburoc4.Robot.

% SPDX-License-Identifier: MIT
furthest = 0;
reached_s = 0;
while true
    p = roburoc4_mex('progress', id);
    if p.ready
        break
    end
    if p.step > furthest
        furthest = p.step;
        reached_s = p.time_s;
    end
    silence_s = p.time_s;
    if p.received > 0
        silence_s = min(p.silence_s, p.time_s);
    end
    if silence_s >= timeout
        error('roburoc4:timeout', ['no answer from %s for %g s (state %s, %d datagrams sent, %d ' ...
            'received): %s'], p.address, timeout, p.state, p.sent, p.received, remedy(p));
    end
    if p.time_s - reached_s >= timeout
        error('roburoc4:timeout', ['%s is not ready: it answers, but refuses or leaves out what ' ...
            'is needed (no progress for %g s, state %s, %d datagrams received, %d of them ' ...
            'refusals). Check that it is a RobuROC4 and that the network loses little, or give ' ...
            'a longer timeout'], p.address, timeout, p.state, p.received, p.refused);
    end
    roburoc4_mex('wait', id, 0.01);
end
ready_s = p.time_s;
while wait_for_data && ~p.data && p.time_s < ready_s + 2.6
    roburoc4_mex('wait', id, 0.01);
    p = roburoc4_mex('progress', id);
end
end

function text = remedy(p)
if ~isempty(p.fault)
    text = p.fault;
elseif p.received == 0
    text = ['check that the robot is on, the cable is in, this machine has an address in the ' ...
        'robot''s network, and no firewall drops UDP'];
else
    text = 'something answers there; check that it is a RobuROC4, and check link';
end
end
