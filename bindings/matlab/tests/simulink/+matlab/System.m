classdef System < handle
%SYSTEM A stand-in for MATLAB's matlab.System, for tests in Octave.
%   It calls the methods of a subclass in the order that MathWorks documents, and no others.
%
%   Example:
%      s = roburoc4.System(); s.step(0.3, 0, true); s.release()

% SPDX-License-Identifier: MIT
properties (Access = private)
    is_set_up = false
end

methods
    function setProperties(this, count, varargin)
        for k = 1:2:count
            this.(varargin{k}) = varargin{k + 1};
        end
    end

    function varargout = step(this, varargin)
        if ~this.is_set_up
            this.validatePropertiesImpl();
            this.setupImpl();
            this.resetImpl();
            this.is_set_up = true;
        end
        [varargout{1:this.getNumOutputsImpl()}] = this.outputImpl(varargin{:});
        this.updateImpl(varargin{:});
    end

    function reset(this)
        this.resetImpl();
    end

    function release(this)
        if this.is_set_up
            this.releaseImpl();
            this.is_set_up = false;
        end
    end


    function s = createSampleTime(~, varargin)
        s = struct(varargin{:});
    end
end
end
