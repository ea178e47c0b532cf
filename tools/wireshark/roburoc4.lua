-- SPDX-License-Identifier: MIT
--
-- Wireshark's and tshark's dissector for the RobuROC4's UDP protocol: every telegram of the manual,
-- in both directions. Put this file into a folder for plugins (Help > About > Folders), or let
-- `roburoc4 dissector --install` do that.
--
-- Recordings of roburoc4_record.h and port 60000 are known; for another one use Analyze > Decode As, or `tshark -d udp.port==N,roburoc4`.

local roburoc4 = Proto("roburoc4", "RobuROC4")

-- Every packet leaves garbage. By its usual settings Lua collects so late, and so slowly, that a long
-- capture costs three times the memory with Wireshark 4.4; newer ones may not have these settings.
pcall(collectgarbage, "setpause", 110)
pcall(collectgarbage, "setstepmul", 400)

roburoc4.prefs.watchdog_ms = Pref.uint("Watchdog in ms", 1000,
    "How long after the last command the robot stops by itself (4.2.5.6)")
roburoc4.prefs.late_ms = Pref.uint("Late statuses in ms", 100,
    "Statuses that took this much longer than the fastest one are reported")

---------------------------------------------------------------------------------------- the table

-- The structs of roburoc4_codec.h: the names of their members in filters, and their layout on
-- the wire. Members are in the order of the wire; {name, type, label, names of values}. A type is
-- that of C, or what a view in C has: "f32[]", "u8[]", "text".
local ACTIONS = {[0] = "GET", "QUERY", "REPLACE", "UPDATE", "INSERT", "DELETE", "SUBMIT"}
local ERRORS = {[0] = "none", "no such service", "action not supported by the service",
    "no such action", "wrong length", "wrong value"}
local IO_TYPES = {[0] = "analog input", "analog output", "digital input", "digital output"}
local BATTERY_STATES = {[0] = "Charging", "Charged", "Ok", "Critical"}
local TYPES = {[0x0002] = "diagnostic", [0x4001] = "IO card", [0x4004] = "laser",
    [0x4005] = "differential", [0x4008] = "telemeter", [0x4009] = "drive",
    [0x8002] = "localization"}
local FLAGS = {"invalid", "metric", "decimetric", "centimetric", "proprioceptive",
    "exteroceptive", "error"}

local POSE = {
    {"x_m", "f64", "X in m"}, {"y_m", "f64", "Y in m"}, {"theta_rad", "f64", "Orientation in rad"},
}

local STRUCTS = {
    -- roburoc4_request, roburoc4_answer and roburoc4_status_header begin telegrams of all kinds
    head = {
        {"id", "u8", "Request id"},
        {"action", "u8", "Action", ACTIONS},
        {"service", "u16", "Service"},
        {"error", "u8", "Error", ERRORS},
        {"robot_cycles", "u64", "Robot's time in cycles of 10 ms"},
    },
    request = {
        {"subject", "u16", "Service whose statuses are meant"},
        {"period_cycles", "u8", "Period in cycles of 10 ms"},
        {"io_type", "u8", "Channel type", IO_TYPES},
        {"index", "i32", "Index"},
        {"timestamp", "u64", "Time (not used)"},
        POSE[1], POSE[2], POSE[3],
    },
    directory_entry = {{"type", "u16", "Type", TYPES}, {"id", "u16", "Service"}},
    subscription = {{"service", "u16", "Service"}, {"period_cycles", "u8", "Period in cycles of 10 ms"}},
    iocard_properties = {
        {"analog_inputs", "i32", "Analog inputs"}, {"analog_outputs", "i32", "Analog outputs"},
        {"digital_inputs", "i32", "Digital inputs"}, {"digital_outputs", "i32", "Digital outputs"},
    },
    telemeter = {
        {"x_m", "f32", "X in m"}, {"y_m", "f32", "Y in m"},
        {"theta_rad", "f32", "Orientation in rad"},
        {"field_of_view_rad", "f32", "Field of view in rad"},
        {"min_distance_m", "f32", "Least distance in m"},
        {"max_distance_m", "f32", "Greatest distance in m"},
        {"distance_m", "f32", "Distance in m"},
    },
    battery_properties = {
        {"nominal_voltage_v", "f32", "Nominal voltage in V"},
        {"capacity_ah", "f32", "Capacity in Ah"},
        {"minimum_percent", "u8", "Least charge in %"},
    },
    localization_properties = {POSE[1], POSE[2], POSE[3], {"flags", "u32", "Flags"}},
    differential_properties = {
        {"target_linear_m_s", "f32", "Target speed in m/s"},
        {"target_angular_rad_s", "f32", "Target turn rate in rad/s"},
        {"current_linear_m_s", "f32", "Speed in m/s"},
        {"current_angular_rad_s", "f32", "Turn rate in rad/s"},
        {"max_linear_m_s", "f32", "Greatest speed in m/s"},
        {"min_linear_m_s", "f32", "Least speed in m/s"},
        {"max_angular_rad_s", "f32", "Greatest turn rate in rad/s"},
        {"min_angular_rad_s", "f32", "Least turn rate in rad/s"},
        {"max_linear_m_s2", "f32", "Greatest acceleration in m/s2"},
        {"min_linear_m_s2", "f32", "Least acceleration in m/s2"},
        {"max_angular_rad_s2", "f32", "Greatest angular acceleration in rad/s2"},
        {"min_angular_rad_s2", "f32", "Least angular acceleration in rad/s2"},
        {"width_m", "f32", "Width in m"},
    },
    text = {{"text", "text", "Text"}},
    channels = {{"analog", "f32[]", "Analog"}, {"digital", "u8[]", "Digital"}},
    telemeter_status = {{"distances", "f32[]", "Distance in m"}},
    battery_status = {
        {"state", "u8", "State", BATTERY_STATES}, {"remaining_percent", "u8", "Charge in %"},
    },
    localization_status = {POSE[1], POSE[2], POSE[3], {"flags", "u32", "Flags"}},
    differential_status = {
        {"target_linear_m_s", "f32", "Target speed in m/s"},
        {"current_linear_m_s", "f32", "Speed in m/s"},
        {"target_angular_rad_s", "f32", "Target turn rate in rad/s"},
        {"current_angular_rad_s", "f32", "Turn rate in rad/s"},
    },
    differential_command = {
        {"linear_m_s", "f32", "Speed in m/s"}, {"angular_rad_s", "f32", "Turn rate in rad/s"},
    },
}

-- What comes before a member in a filter: the struct's name without what kind of telegram it is.
local PREFIXES = {head = "", text = "", directory_entry = "directory", channels = "iocard"}

-- Channels of the IO card by index, as ROBUROC4_AI_* and ROBUROC4_DI_* of the header.
local ANALOG_INPUTS = {[0] = "front_telemeter_v", "rear_telemeter_v", "battery_v", "pad_lj_x",
    "pad_lj_y", "pad_rj_x", "pad_rj_y", "pad_lt", "pad_rt"}
local DIGITAL_INPUTS = {[0] = "front_bumper", "rear_bumper", [8] = "pad_a", [9] = "pad_b",
    [10] = "pad_x", [11] = "pad_y", [12] = "pad_back", [13] = "pad_start", [14] = "pad_d_down",
    [15] = "pad_d_left", [16] = "pad_d_right", [17] = "pad_d_up", [18] = "pad_lj_click",
    [19] = "pad_rj_click", [20] = "pad_lb", [21] = "pad_rb"}

----------------------------------------------------------------------------------- fields, experts

local SIZES = {u8 = 1, u16 = 2, i32 = 4, u32 = 4, u64 = 8, f32 = 4, f64 = 8}
local MAKERS = {
    u8 = ProtoField.uint8, u16 = ProtoField.uint16, i32 = ProtoField.int32,
    u32 = ProtoField.uint32, u64 = ProtoField.uint64, ["u8[]"] = ProtoField.bytes,
}
local READERS = {
    u8 = "le_uint", u16 = "le_uint", i32 = "le_int", u32 = "le_uint", u64 = "le_uint64",
    f32 = "le_float", f64 = "le_float",
}

local fields = {} -- by the filter's name

local function make_field(name, kind, label, values)
    if kind == "f32" or kind == "f32[]" then
        return ProtoField.float(name, label)
    elseif kind == "f64" then
        return ProtoField.double(name, label)
    elseif kind == "text" then
        return ProtoField.string(name, label)
    elseif kind == "u8[]" then
        return ProtoField.bytes(name, label)
    end
    return MAKERS[kind](name, label, base.DEC, values)
end

local function add_field(name, kind, label, values)
    if fields[name] == nil then
        fields[name] = make_field(name, kind, label, values)
    end
    return fields[name]
end

for struct, members in pairs(STRUCTS) do
    local prefix = PREFIXES[struct] or struct:gsub("_properties$", ""):gsub("_status$", "")
        :gsub("_command$", "")
    prefix = "roburoc4." .. prefix .. (prefix == "" and "" or ".")
    local own = {}
    for i, member in ipairs(members) do
        own[i] = {name = member[1], kind = member[2], values = member[4],
            field = add_field(prefix .. member[1], member[2], member[3], member[4])}
        own[member[1]] = own[i].field
    end
    STRUCTS[struct] = own
end

local analog_fields, digital_fields, flag_fields = {}, {}, {}
for i, name in pairs(ANALOG_INPUTS) do
    analog_fields[i] = add_field("roburoc4.iocard.ai." .. name, "f32", name)
end
for i, name in pairs(DIGITAL_INPUTS) do
    local full = "roburoc4.iocard.di." .. name
    fields[full] = ProtoField.bool(full, name)
    digital_fields[i] = fields[full]
end
for i, name in ipairs(FLAGS) do
    local full = "roburoc4.localization.flags." .. name
    fields[full] = ProtoField.bool(full, name, 32, nil, 2 ^ (i - 1))
    flag_fields[i] = fields[full]
end

-- What the dissector concludes.
local f_answer_in = ProtoField.framenum("roburoc4.answer_in", "Answer in", base.NONE,
    frametype.RESPONSE)
local f_request_in = ProtoField.framenum("roburoc4.request_in", "Request in", base.NONE,
    frametype.REQUEST)
local f_answer_time = ProtoField.relative_time("roburoc4.answer_time", "Time since the request")
local f_lost = ProtoField.uint32("roburoc4.lost", "Statuses lost before this one")
local f_late_ms = ProtoField.float("roburoc4.late_ms", "Later than the soonest status, in ms")
local f_period = ProtoField.uint32("roburoc4.period_cycles", "Subscribed period in cycles of 10 ms")
local f_surplus = ProtoField.bytes("roburoc4.surplus", "Bytes beyond the layout")
local f_data = ProtoField.bytes("roburoc4.data", "Bytes without a known layout")
for _, field in ipairs({f_answer_in, f_request_in, f_answer_time, f_lost, f_late_ms, f_period,
    f_surplus, f_data}) do
    fields[#fields + 1] = field
end
roburoc4.fields = fields

local experts = {}
local function add_expert(name, text, group, severity)
    experts[name] = ProtoExpert.new("roburoc4.expert." .. name, text, group, severity)
end
add_expert("refused", "The robot refused", expert.group.RESPONSE_CODE, expert.severity.WARN)
add_expert("malformed", "Malformed telegram", expert.group.MALFORMED, expert.severity.ERROR)
add_expert("surplus", "Bytes beyond the layout", expert.group.PROTOCOL, expert.severity.NOTE)
add_expert("cut", "The capture holds only the beginning of this telegram",
    expert.group.UNDECODED, expert.severity.NOTE)
add_expert("unknown", "A telegram that the manual does not have", expert.group.UNDECODED,
    expert.severity.NOTE)
add_expert("counts", "The counts of channels are not in this capture: those of the manual are used",
    expert.group.ASSUMPTION, expert.severity.CHAT)
add_expert("unmatched", "No request in this capture fits: a late or duplicate answer",
    expert.group.SEQUENCE, expert.severity.NOTE)
add_expert("unanswered", "No answer in this capture", expert.group.SEQUENCE,
    expert.severity.NOTE)
add_expert("lost", "Statuses were lost", expert.group.SEQUENCE, expert.severity.WARN)
add_expert("old", "A status that is not newer than the one before", expert.group.SEQUENCE,
    expert.severity.NOTE)
add_expert("late", "A status came late", expert.group.SEQUENCE, expert.severity.NOTE)
add_expert("restart", "The robot restarted", expert.group.SEQUENCE, expert.severity.WARN)
add_expert("limits", "A speed is outside the robot's limits", expert.group.PROTOCOL,
    expert.severity.WARN)
add_expert("not_finite", "A speed is not a finite number", expert.group.PROTOCOL, expert.severity.ERROR)
add_expert("watchdog_tripped", "The robot's watchdog has stopped it", expert.group.SEQUENCE,
    expert.severity.WARN)
add_expert("watchdog_due", "More than half of the watchdog's time passed without a command",
    expert.group.SEQUENCE, expert.severity.NOTE)
roburoc4.experts = experts

------------------------------------------------------------------------------- what was learned

-- Datagrams are first seen in their order. What is concluded then is kept with the frame, as
-- Wireshark shows frames again in any order.
local robots -- by address and port
local flows -- by address and port of the sender, then of the receiver
-- By number: a context, which frames share as long as nothing changes, or a record with what was
-- concluded of one frame, on top of its context.
local frames
-- By port: the latest address with it and its key, since writing an address costs far more than
-- comparing it.
local latest_ends
local watchdog_ms, late_limit_ms -- of the preferences: looking them up costs as much as a status

local MANUAL_KINDS = {[0] = "directory", "notification", "iocard", "telemeter", "battery",
    "localization", "differential"}
local KIND_NAMES = {directory = "Directory", notification = "Notification", iocard = "IOCard",
    telemeter = "Telemeter", battery = "Battery", localization = "Localization",
    differential = "Differential"}
local TYPE_KINDS = {[0x4001] = "iocard", [0x4005] = "differential", [0x4008] = "telemeter",
    [0x8002] = "localization"}
local TEXT_KINDS = {"differential", "localization", "telemeter", "battery", "iocard"}
local MANUAL_COUNTS = {analog_inputs = 9, analog_outputs = 0, digital_inputs = 22,
    digital_outputs = 8}
local HIGHEST_COUNT = 4096 -- beyond it a count is not believed

local DEFAULT_PORT = 60000
local RESTART_CYCLES = 100
local CYCLE_S = 0.01

function roburoc4.init()
    robots, flows, frames, latest_ends = {}, {}, {}, {}
    watchdog_ms, late_limit_ms = roburoc4.prefs.watchdog_ms, roburoc4.prefs.late_ms
end

local function new_robot()
    return {kinds = MANUAL_KINDS, counts = nil, limits = nil, entries = {}, texts = {},
        clients = {}}
end

local function new_client()
    return {pending = {}, periods = {}, last = {}, steps = {}}
end

local function end_key(address, port)
    local latest = latest_ends[port]
    if latest == nil or latest.address ~= address then
        latest = {address = address, key = tostring(address) .. " " .. port}
        latest_ends[port] = latest
    end
    return latest.key
end

local function side_keys(pinfo)
    return end_key(pinfo.src, pinfo.src_port), end_key(pinfo.dst, pinfo.dst_port)
end

-- Whether the bytes look like what a client sends.
local function looks_sent(buf)
    local size = buf:len()
    if size < 4 then
        return size == 3 and buf(0, 1):uint() == 0xFF
    end
    local first, action = buf(0, 1):uint(), buf(1, 1):uint()
    if first == 0xFF then
        return size <= 11
    end
    local to_notification = buf(2, 2):le_uint() == 1
    return size == 4 or (action == 1 and (size == 6 or size == 9)) or
        (action == 2 and size == 36) or (action == 4 and size == 7 and to_notification) or
        (action == 5 and size == 6 and to_notification)
end

local interface_name = Field.new("frame.interface_name")
local SENT, RECEIVED = 0, 1

-- Whether this is of a recording of roburoc4_record.h: there the interface has the robot's address
-- or the name of the program.
local function is_recording(pinfo)
    local found = interface_name()
    local name = found and tostring(found.value) or ""
    local port = tonumber(name:match(":(%d+)$"))
    return name:find("^roburoc4") ~= nil or
        (port ~= nil and (port == pinfo.src_port or port == pinfo.dst_port))
end

-- Whether a client sends this: in a recording of a client, by its direction; else by the manual's
-- port, by what was learned of both ends, by the port of Decode As, or by its contents. True, too,
-- if that is so for all that the same sender sends to the same receiver.
local function goes_to_robot(pinfo, buf, source, target)
    local from, to = pinfo.src_port, pinfo.dst_port
    local direction = pinfo.p2p_dir
    if (direction == SENT or direction == RECEIVED) and is_recording(pinfo) then
        return direction == SENT, true
    elseif (from == DEFAULT_PORT) ~= (to == DEFAULT_PORT) then
        return to == DEFAULT_PORT, true
    elseif source ~= target and (robots[source] == nil) ~= (robots[target] == nil) then
        return robots[target] ~= nil
    elseif from ~= to and (pinfo.match_uint == from or pinfo.match_uint == to) then
        return pinfo.match_uint == to
    end
    return looks_sent(buf)
end

local function flow_of(pinfo, buf)
    local source, target = side_keys(pinfo)
    local targets = flows[source]
    local flow = targets and targets[target]
    if flow ~= nil and flow.is_fixed then
        return flow
    end
    local to_robot, is_fixed = goes_to_robot(pinfo, buf, source, target)
    local key, client = source, target
    if to_robot then
        key, client = target, source
    end
    robots[key] = robots[key] or new_robot()
    local robot = robots[key]
    robot.clients[client] = robot.clients[client] or new_client()
    flow = {to_robot = to_robot, is_fixed = is_fixed, robot = robot, client = robot.clients[client]}
    flows[source] = flows[source] or {}
    flows[source][target] = flow
    return flow
end

-- What is known of both ends now.
local function context_of(flow)
    local robot, client, context = flow.robot, flow.client, flow.context
    if context == nil or context.kinds ~= robot.kinds or context.counts ~= robot.counts or
        context.limits ~= robot.limits or context.periods ~= client.periods or
        context.offset ~= client.offset then
        context = {to_robot = flow.to_robot, robot = robot, client = client, kinds = robot.kinds,
            counts = robot.counts, limits = robot.limits, periods = client.periods,
            offset = client.offset}
        context.__index = context
        flow.context = context
    end
    return context
end

local function note(record, name, text)
    local notes = record.notes or {}
    notes[#notes + 1] = {name, text}
    record.notes = notes
end

local function kind_of_entry(robot, index)
    local entry, text = robot.entries[index], robot.texts[index]
    local kind = TYPE_KINDS[entry.type]
    if kind == nil and text ~= nil then
        local plain = text:lower():gsub("%A", "")
        for _, name in ipairs(TEXT_KINDS) do
            if plain:find(name, 1, true) then
                return name
            end
        end
    end
    return kind
end

-- Which service is which: by type or text, and by the manual's number if neither identifies it.
local function learn_kinds(robot)
    local kinds, claimed = {[0] = "directory", [1] = "notification"}, {}
    for index, entry in pairs(robot.entries) do
        local kind = kind_of_entry(robot, index)
        if entry.id > 1 and kind ~= nil then
            kinds[entry.id] = kind
            claimed[kind] = true
        end
    end
    for _, entry in pairs(robot.entries) do
        local kind = MANUAL_KINDS[entry.id]
        if kinds[entry.id] == nil and kind ~= nil and not claimed[kind] then
            kinds[entry.id] = kind
        end
    end
    robot.kinds = kinds
end

local function learn_request(record, v, pinfo)
    record.is_request = true
    table.insert(record.client.pending, {frame = pinfo.number, at = pinfo.rel_ts, id = v.id,
        action = v.action, service = v.service, subject = v.subject, period = v.period_cycles,
        index = v.index})
end

-- The latest request that an answer fits; for an error telegram (id 0) the oldest.
local function take_request(pending, v)
    local found
    for i, request in ipairs(pending) do
        local fits = v.action == nil or
            (request.action == v.action and request.service == v.service)
        if fits and (v.id == 0 or request.id == v.id) then
            found = i
            if v.id == 0 then
                break
            end
        end
    end
    return found and table.remove(pending, found)
end

-- Contexts refer to the table, so it never changes.
local function set_period(client, service, period)
    local periods = {}
    for other, value in pairs(client.periods) do
        periods[other] = value
    end
    periods[service] = period
    client.periods = periods
end

local function learn_properties(record, v, request)
    local robot = record.robot
    local kind = record.kinds[v.service]
    if v.short then
        return
    elseif v.action == 0 and kind == "directory" then
        robot.entries = v.entries
        learn_kinds(robot)
    elseif v.action == 1 and kind == "directory" and robot.entries[request.index] ~= nil then
        robot.texts[request.index] = v.text
        learn_kinds(robot)
    elseif v.action == 0 and kind == "iocard" then
        robot.counts = v
    elseif v.action == 0 and kind == "differential" then
        robot.limits = v
    elseif v.action == 4 and request.period ~= nil and request.period > 0 then
        set_period(record.client, request.subject, request.period)
    elseif v.action == 5 and request.subject ~= nil then
        set_period(record.client, request.subject, nil)
    end
end

local function learn_answer(record, v, pinfo)
    local request = take_request(record.client.pending, v)
    if request == nil then
        note(record, "unmatched")
        return
    end
    record.request = request.frame
    record.time = pinfo.rel_ts - request.at
    if frames[request.frame] ~= nil then
        frames[request.frame].answer = pinfo.number -- a record, as it is of a request
    end
    if v.error == 0 and v.id ~= 0 then
        learn_properties(record, v, request)
    end
end

-- How far the capture's clock is ahead of the robot's: least with the soonest status.
local function offset_of(v, pinfo)
    return pinfo.rel_ts - v.cycles * CYCLE_S
end

local function learn_lateness(record, v, pinfo)
    local client = record.client
    local offset = offset_of(v, pinfo)
    if client.offset == nil or offset < client.offset then
        client.offset = offset
    end
    local late = (offset - client.offset) * 1000
    if late >= late_limit_ms then
        note(record, "late", string.format("This status came %.0f ms late", late))
    end
end

-- The period that was subscribed to, or else the shortest step that was seen.
local function learn_gap(record, v, step)
    local client, service = record.client, v.service
    local period = client.periods[service]
    if period == nil then
        client.steps[service] = math.min(step, client.steps[service] or step)
        period = client.steps[service]
    end
    local lost = math.floor(step / period + 0.5) - 1
    if lost > 0 then
        record.lost = lost
        note(record, "lost", string.format("%d statuses were lost before this one", lost))
    end
end

local function learn_status(record, v, pinfo)
    local client = record.client
    if v.cycles == nil then
        return
    end
    local last = client.last[v.service]
    if last ~= nil and v.cycles + RESTART_CYCLES < last then
        note(record, "restart", "The robot's time went back: it restarted")
        client.last, client.offset, last = {}, nil, nil
    end
    learn_lateness(record, v, pinfo)
    if last ~= nil and v.cycles <= last then
        note(record, "old")
        return
    elseif last ~= nil then
        learn_gap(record, v, v.cycles - last)
    end
    client.last[v.service] = v.cycles
end

-- Commands of all clients count, as for the robot's watchdog.
local function learn_command(record, v, pinfo)
    local robot = record.robot
    local waited_ms = robot.commanded_at and (pinfo.rel_ts - robot.commanded_at) * 1000
    if robot.moving and not robot.watchdog_tripped and waited_ms <= watchdog_ms and
        waited_ms > watchdog_ms / 2 then
        note(record, "watchdog_due", string.format("%.0f ms passed without a command: "
            .. "the robot's watchdog stops it after %d", waited_ms, watchdog_ms))
    end
    robot.commanded_at = pinfo.rel_ts
    robot.moving = v.linear_m_s ~= 0 or v.angular_rad_s ~= 0
    robot.watchdog_tripped = false
end

local function watch_the_watchdog(record, pinfo)
    local robot = record.robot
    if not robot.moving or robot.watchdog_tripped then
        return
    end
    local waited_ms = (pinfo.rel_ts - robot.commanded_at) * 1000
    if waited_ms > watchdog_ms then
        robot.watchdog_tripped = true
        note(record, "watchdog_tripped", string.format(
            "No command for %.0f ms: the robot's watchdog has stopped it", waited_ms))
    end
end

----------------------------------------------------------------------------------------- layouts

-- What is read of a telegram: the cursor fails once, and then for good, where bytes are missing.
local function new_reader(buf, tree)
    return {buf = buf, size = buf:len(), at = 0, tree = tree, short = false}
end

local function fits(reader, size)
    if reader.short or reader.at + size > reader.size then
        reader.short = true
    end
    return not reader.short
end

local function read_member(reader, tree, member)
    local size = SIZES[member.kind]
    if not fits(reader, size) then
        return nil
    end
    local range = reader.buf(reader.at, size)
    reader.at = reader.at + size
    tree:add_le(member.field, range)
    local value = range[READERS[member.kind]](range)
    if member.kind == "u64" then
        value = value:tonumber()
    end
    return value
end

-- The members of a struct from here on; those that are named, or all.
local function read_struct(reader, tree, struct, names)
    local values = {}
    for _, member in ipairs(STRUCTS[struct]) do
        if names == nil or names[member.name] then
            values[member.name] = read_member(reader, tree, member)
        end
    end
    return values
end

local function named(...)
    local names = {}
    for _, name in ipairs({...}) do
        names[name] = true
    end
    return names
end

local function read_list(reader, v, struct, size, title)
    local entries, index = {}, 0
    while not reader.short and reader.size - reader.at >= size do
        local tree = reader.tree:add(roburoc4, reader.buf(reader.at, size),
            string.format("%s %d", title, index))
        entries[index] = read_struct(reader, tree, struct)
        index = index + 1
    end
    v.entries = entries
    return entries, index
end

local function read_text(reader, v)
    local size = reader.size - reader.at
    if size > 0 then
        local range = reader.buf(reader.at, size)
        reader.tree:add(STRUCTS.text.text, range)
        v.text = range:string(ENC_UTF_8)
    else
        v.text = ""
    end
    reader.at = reader.size
end

local function read_floats(reader, field, count, names)
    for i = 0, count - 1 do
        if not fits(reader, 4) then
            return
        end
        local range = reader.buf(reader.at, 4)
        local item = reader.tree:add_le(field, range)
        item:append_text(string.format(" (%d)", i))
        if names ~= nil and names[i] ~= nil then
            item:add_le(names[i], range)
        end
        reader.at = reader.at + 4
    end
end

local function add_bits(item, buf, at, count, names)
    for channel, field in pairs(names) do
        if channel < count then
            local range = buf(at + math.floor(channel / 8), 1)
            item:add(field, range, range:bitfield(7 - channel % 8, 1) == 1)
        end
    end
end

-- analog and digital are counts, or nil if they are unknown.
local function read_channels(reader, analog, digital, analog_names, digital_names)
    local blocks = digital > 0 and math.floor((digital - 1) / 8) + 1 or 0
    if not fits(reader, 4 * analog + blocks) then
        return
    end
    local is_manual = analog == MANUAL_COUNTS.analog_inputs and
        digital == MANUAL_COUNTS.digital_inputs
    read_floats(reader, STRUCTS.channels.analog, analog, is_manual and analog_names or nil)
    if blocks > 0 then
        local item = reader.tree:add(STRUCTS.channels.digital, reader.buf(reader.at, blocks))
        if is_manual and digital_names ~= nil then
            add_bits(item, reader.buf, reader.at, digital, digital_names)
        end
        reader.at = reader.at + blocks
    end
end

local function read_flags(reader, size)
    local range = reader.buf(reader.at - 4, 4)
    for _, field in ipairs(flag_fields) do
        reader.tree:add_le(field, range)
    end
end

local function read_localization(reader, v, struct)
    v.pose = read_struct(reader, reader.tree, struct)
    if not reader.short then
        read_flags(reader)
        v.info = string.format("x %.3f m, y %.3f m, theta %.3f rad", v.pose.x_m, v.pose.y_m,
            v.pose.theta_rad)
    end
end

local function merge(v, values)
    for name, value in pairs(values) do
        v[name] = value
    end
end

local function is_count(value)
    return value ~= nil and value >= 0 and value <= HIGHEST_COUNT
end

local PROPERTIES = {
    directory = function(reader, v)
        local _, count = read_list(reader, v, "directory_entry", 4, "Service")
        v.info = count .. " services"
    end,
    notification = function(reader, v)
        local _, count = read_list(reader, v, "subscription", 3, "Subscription")
        v.info = count .. " subscriptions"
    end,
    iocard = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "iocard_properties"))
        if not (is_count(v.analog_inputs) and is_count(v.analog_outputs) and
            is_count(v.digital_inputs) and is_count(v.digital_outputs)) then
            reader.short = true
        end
    end,
    telemeter = function(reader, v)
        if not fits(reader, 4) then
            return
        end
        local count = reader.buf(reader.at, 4):le_int()
        reader.tree:add(reader.buf(reader.at, 4), "Telemeters: " .. count)
        reader.at = reader.at + 4
        if count < 0 or reader.at + 28 * count > reader.size then
            reader.short = true
            return
        end
        for i = 0, count - 1 do
            local tree = reader.tree:add(roburoc4, reader.buf(reader.at, 28), "Telemeter " .. i)
            read_struct(reader, tree, "telemeter")
        end
        v.info = count .. " telemeters"
    end,
    battery = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "battery_properties"))
    end,
    localization = function(reader, v)
        read_localization(reader, v, "localization_properties")
    end,
    differential = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "differential_properties"))
    end,
}

local function speeds_text(v)
    return string.format("%.3f m/s, %.3f rad/s", v.current_linear_m_s or v.linear_m_s,
        v.current_angular_rad_s or v.angular_rad_s)
end

local STATUSES = {
    iocard = function(reader, v, record)
        local counts = record.counts or MANUAL_COUNTS
        v.assumed = record.counts == nil
        read_channels(reader, counts.analog_inputs, counts.digital_inputs, analog_fields,
            digital_fields)
    end,
    telemeter = function(reader)
        read_floats(reader, STRUCTS.telemeter_status.distances,
            math.floor((reader.size - reader.at) / 4))
    end,
    battery = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "battery_status"))
        if not reader.short then
            v.info = string.format("%s, %d %%", BATTERY_STATES[v.state] or v.state,
                v.remaining_percent)
        end
    end,
    localization = function(reader, v)
        read_localization(reader, v, "localization_status")
    end,
    differential = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "differential_status"))
        v.info = not reader.short and speeds_text(v) or nil
    end,
}

local COMMANDS = {
    iocard = function(reader, v, record)
        local counts = record.counts or MANUAL_COUNTS
        v.assumed = record.counts == nil
        read_channels(reader, counts.analog_outputs, counts.digital_outputs)
    end,
    differential = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "differential_command"))
        v.info = not reader.short and speeds_text(v) or nil
    end,
}

local INDEX_16 = {name = "index", kind = "u16", field = STRUCTS.request.index}

local REQUESTS = {
    [0] = function() end,
    [1] = function(reader, v)
        if v.kind == "directory" then
            v.index = read_member(reader, reader.tree, INDEX_16)
        else
            merge(v, read_struct(reader, reader.tree, "request", named("io_type", "index")))
        end
    end,
    [2] = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "request",
            named("timestamp", "x_m", "y_m", "theta_rad")))
    end,
    [4] = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "request", named("subject", "period_cycles")))
    end,
    [5] = function(reader, v)
        merge(v, read_struct(reader, reader.tree, "request", named("subject")))
    end,
}

local ANSWERS = {
    [0] = function(reader, v, record)
        local read = PROPERTIES[v.kind]
        if read ~= nil then
            read(reader, v, record)
        else
            v.unknown = true
        end
    end,
    [1] = read_text,
    [2] = function() end,
    [4] = function() end,
    [5] = function() end,
}

--------------------------------------------------------------------------------------- telegrams

local function service_name(kind, service)
    return KIND_NAMES[kind] or (service ~= nil and "service " .. service or "?")
end

local function read_head(reader, v, record, names)
    merge(v, read_struct(reader, reader.tree, "head", names))
    v.kind = v.service and record.kinds[v.service]
    v.cycles = v.robot_cycles
end

local function read_body(reader, v, record, read)
    if reader.short then
        return
    elseif read ~= nil then
        read(reader, v, record)
    else
        v.unknown = true
    end
end

local function read_request(reader, v, record)
    read_head(reader, v, record, named("id", "action", "service"))
    read_body(reader, v, record, REQUESTS[v.action])
    v.title = string.format("%s %s", ACTIONS[v.action] or "action " .. tostring(v.action),
        service_name(v.kind, v.service))
    if v.action == 4 and v.period_cycles ~= nil then
        v.info = string.format("%s every %d ms", service_name(record.kinds[v.subject], v.subject),
            10 * v.period_cycles)
    elseif v.index ~= nil then
        v.info = (v.io_type and (IO_TYPES[v.io_type] or v.io_type) .. " " or "") .. v.index
    end
end

local function read_answer(reader, v, record)
    if reader.size < 5 and reader.buf(0, 1):uint() == 0 then
        v.id, v.title, v.error = 0, "Error telegram", 0xFF
        reader.tree:add(STRUCTS.head.id, reader.buf(0, 1))
        reader.at = reader.size
        return
    end
    read_head(reader, v, record, named("id", "action", "service", "error"))
    v.title = string.format("Answer %s %s", ACTIONS[v.action] or "action " .. tostring(v.action),
        service_name(v.kind, v.service))
    if v.error == 0 then
        read_body(reader, v, record, ANSWERS[v.action])
        v.info = v.info or v.text
    elseif v.error ~= nil then
        v.info = ERRORS[v.error] or "error " .. v.error
    end
end

local function read_status(reader, v, record)
    reader.at = 1
    read_head(reader, v, record, named("service", "robot_cycles"))
    v.title = service_name(v.kind, v.service) .. " status"
    read_body(reader, v, record, STATUSES[v.kind])
end

local function read_command(reader, v, record)
    reader.at = 1
    read_head(reader, v, record, named("service"))
    v.title = service_name(v.kind, v.service) .. " command"
    read_body(reader, v, record, COMMANDS[v.kind])
end

local function read_telegram(reader, record)
    local v = {}
    if reader.size == 0 then
        reader.short = true
        v.title = "Empty datagram"
    elseif reader.buf(0, 1):uint() == 0xFF then
        v.what = record.to_robot and "command" or "status"
        local read = record.to_robot and read_command or read_status
        read(reader, v, record)
    else
        v.what = record.to_robot and "request" or "answer"
        local read = record.to_robot and read_request or read_answer
        read(reader, v, record)
    end
    v.short = reader.short
    return v
end

---------------------------------------------------------------------------------------- checking

local SPEEDS = {
    {"linear_m_s", "max_linear_m_s", "min_linear_m_s"},
    {"angular_rad_s", "max_angular_rad_s", "min_angular_rad_s"},
    {"target_linear_m_s", "max_linear_m_s", "min_linear_m_s"},
    {"target_angular_rad_s", "max_angular_rad_s", "min_angular_rad_s"},
    {"current_linear_m_s", "max_linear_m_s", "min_linear_m_s"},
    {"current_angular_rad_s", "max_angular_rad_s", "min_angular_rad_s"},
}
local ROUNDING = 0.001

local function check_speeds(tree, v, limits)
    for _, names in ipairs(SPEEDS) do
        local speed = v[names[1]]
        local highest, lowest = limits and limits[names[2]], limits and limits[names[3]]
        if speed == nil then
            -- another telegram
        elseif speed ~= speed or speed == math.huge or speed == -math.huge then
            tree:add_proto_expert_info(experts.not_finite, names[1] .. " is not a finite number")
        elseif highest ~= nil and lowest ~= nil and
            (speed > highest + ROUNDING or speed < lowest - ROUNDING) then
            tree:add_proto_expert_info(experts.limits, string.format(
                "%s %.3f is outside the robot's limits, %.3f to %.3f", names[1], speed, lowest,
                highest))
        end
    end
end

local function check_layout(reader, v)
    local tree, buf = reader.tree, reader.buf
    if reader.short and buf:reported_len() > reader.size then
        tree:add_proto_expert_info(experts.cut)
    elseif reader.short then
        tree:add_proto_expert_info(experts.malformed, string.format(
            "Malformed: %d bytes are too few for this telegram, or a count in it is wrong",
            reader.size))
    elseif v.unknown then
        tree:add_proto_expert_info(experts.unknown)
        if reader.at < reader.size then
            tree:add(f_data, buf(reader.at))
        end
    elseif reader.at < reader.size then
        tree:add(f_surplus, buf(reader.at))
        tree:add_proto_expert_info(experts.surplus, string.format(
            "%d bytes beyond the layout", reader.size - reader.at))
    end
    if v.what == "request" and v.id == 0 then
        tree:add_proto_expert_info(experts.malformed, "Malformed: a request's id is 1 to 254")
    end
    if v.error ~= nil and v.error ~= 0 then
        tree:add_proto_expert_info(experts.refused, "The robot refused: " ..
            (ERRORS[v.error] or "error " .. v.error))
    end
    if v.assumed then
        tree:add_proto_expert_info(experts.counts)
    end
end

local function add_generated(tree, field, value)
    tree:add(field, value):set_generated()
end

local function show_conclusions(tree, record, v, pinfo, is_new)
    if record.answer ~= nil then
        add_generated(tree, f_answer_in, record.answer)
    elseif record.is_request and not is_new then -- all others were seen meanwhile
        tree:add_proto_expert_info(experts.unanswered)
    end
    if record.request ~= nil then
        local seconds = math.max(record.time, 0)
        local whole = math.floor(seconds)
        add_generated(tree, f_request_in, record.request)
        add_generated(tree, f_answer_time,
            NSTime.new(whole, math.floor((seconds - whole) * 1e9 + 0.5)))
    end
    if v.what == "status" and v.cycles ~= nil then
        if record.periods[v.service] ~= nil then
            add_generated(tree, f_period, record.periods[v.service])
        end
        if record.offset ~= nil then
            add_generated(tree, f_late_ms, (offset_of(v, pinfo) - record.offset) * 1000)
        end
    end
    if record.lost ~= nil then
        add_generated(tree, f_lost, record.lost)
    end
end

local function show_notes(tree, record)
    for _, entry in ipairs(record.notes or {}) do
        if entry[2] ~= nil then
            tree:add_proto_expert_info(experts[entry[1]], entry[2])
        else
            tree:add_proto_expert_info(experts[entry[1]])
        end
    end
end

local LEARNERS = {request = learn_request, answer = learn_answer, status = learn_status}

local function learn(record, v, pinfo)
    watch_the_watchdog(record, pinfo)
    if v.short and v.what ~= "answer" then
        return
    elseif LEARNERS[v.what] ~= nil then
        LEARNERS[v.what](record, v, pinfo)
    elseif v.what == "command" and v.kind == "differential" then
        learn_command(record, v, pinfo)
    end
end

----------------------------------------------------------------------------------- the short way

-- Most telegrams are statuses and speeds, and most of the time nobody looks at their fields: a
-- filter on other fields, the list of packets, a first reading. Then their numbers are read alone.
-- By kind: the size, the numbers behind the head, and their names.
local SHORT_STATUSES = {
    differential = {size = 27, format = "<I8ffff", "target_linear_m_s", "current_linear_m_s",
        "target_angular_rad_s", "current_angular_rad_s"},
    localization = {size = 39, format = "<I8ddd", "x_m", "y_m", "theta_rad"},
    battery = {size = 13, format = "<I8BB", "state", "remaining_percent"},
    telemeter = {format = "<I8"},
    iocard = {format = "<I8"},
}
local STATUS_HEAD = 11
local COMMAND_SIZE = 11
local TITLES = {}
for kind, name in pairs(KIND_NAMES) do
    TITLES[kind] = {status = name .. " status", command = name .. " command"}
end

local SHORT_INFOS = {
    differential = function(v) return speeds_text(v) end,
    localization = function(v)
        return string.format("x %.3f m, y %.3f m, theta %.3f rad", v.x_m, v.y_m, v.theta_rad)
    end,
    battery = function(v)
        return string.format("%s, %d %%", BATTERY_STATES[v.state] or v.state, v.remaining_percent)
    end,
}

local function has_size(kind, layout, size, counts)
    if kind == "telemeter" then
        return size >= STATUS_HEAD and (size - STATUS_HEAD) % 4 == 0
    elseif kind == "iocard" then
        counts = counts or MANUAL_COUNTS
        return size == STATUS_HEAD + 4 * counts.analog_inputs +
            math.floor((counts.digital_inputs + 7) / 8)
    end
    return size == layout.size
end

-- The values of a status or a speed command of the right size; else nil.
local function read_shortly(buf, context)
    local size = buf:len()
    if size < COMMAND_SIZE then
        return nil
    end
    local raw = buf:raw()
    local first, low, high = raw:byte(1, 3)
    if first ~= 0xFF then
        return nil
    end
    local service = low + 256 * high
    local kind = context.kinds[service]
    local v = {service = service, kind = kind}
    if context.to_robot then
        if kind ~= "differential" or size ~= COMMAND_SIZE then
            return nil
        end
        v.what = "command"
        v.linear_m_s, v.angular_rad_s = Struct.unpack("<ff", raw, 4)
    else
        local layout = SHORT_STATUSES[kind]
        if layout == nil or not has_size(kind, layout, size, context.counts) then
            return nil
        end
        v.what = "status"
        local a, b, c, d
        v.cycles, a, b, c, d = Struct.unpack(layout.format, raw, 4)
        if layout[1] ~= nil then
            v[layout[1]], v[layout[2]] = a, b
            if layout[3] ~= nil then
                v[layout[3]] = c
                if layout[4] ~= nil then
                    v[layout[4]] = d
                end
            end
        end
        v.assumed = kind == "iocard" and context.counts == nil
    end
    v.title = TITLES[kind][v.what]
    local info = SHORT_INFOS[kind]
    v.info = info and info(v)
    return v
end

local itself -- what tells whether anybody looks at a field; known once all plugins are loaded
local icmp_type = Field.new("icmp.type")

function roburoc4.dissector(buf, pinfo, root)
    local tree = root:add(roburoc4, buf())
    local is_quoted = icmp_type() ~= nil -- in the network's report that it was not delivered
    local number = pinfo.number
    local record = not is_quoted and frames[number]
    local is_new = not record
    local flow, context
    if is_new then
        flow = flow_of(pinfo, buf)
        context = context_of(flow)
        record = setmetatable({}, context)
    end
    itself = itself or Dissector.get("roburoc4")
    local is_shown = tree:referenced(itself)
    local v = not is_shown and not is_quoted and read_shortly(buf, record)
    local reader
    if not v then
        reader = new_reader(buf, tree)
        v = read_telegram(reader, record)
    end
    if is_new and not is_quoted then
        learn(record, v, pinfo)
        if next(record) == nil then
            -- what the status itself showed of the time; nothing else
            context = context.offset == flow.client.offset and context or context_of(flow)
            record = context
        elseif v.what == "status" then
            record.offset = flow.client.offset
        end
        frames[number] = record
    end
    if reader ~= nil then
        check_layout(reader, v)
    elseif v.assumed then
        tree:add_proto_expert_info(experts.counts)
    end
    if v.kind == "differential" and not v.short then
        check_speeds(tree, v, record.limits)
    end
    if reader ~= nil then
        show_conclusions(tree, record, v, pinfo, is_new)
    end
    show_notes(tree, record)
    if not is_quoted then
        local cols = pinfo.cols
        cols.protocol = "RobuROC4"
        cols.info = v.title .. (v.info and ": " .. v.info or "")
    end
    if is_shown then
        tree:append_text(", " .. v.title)
    end
end

DissectorTable.get("udp.port"):add(DEFAULT_PORT, roburoc4)

-- Recordings, whatever the port.
roburoc4:register_heuristic("udp", function(buf, pinfo, root)
    if not is_recording(pinfo) then
        return false
    end
    pinfo.conversation = roburoc4 -- what follows between these two needs no second look
    roburoc4.dissector(buf, pinfo, root)
    return true
end)
