"""Exudyn: the oscillator of input/sdof with a penalty contact for its wall, 2e5 steps to t = 20."""
import numpy as np
import peer

exu = peer.need('exudyn')
END, STEPS, SAMPLES = 20.0, 200000, 2000


def run(stiffness):
    """Seconds, and the largest error of the displacement."""
    import exudyn.itemInterface as items
    system = exu.SystemContainer()
    model = system.AddSystem()
    node = model.AddNode(items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[1.0]))
    model.AddObject(items.Mass1D(physicsMass=1.0, nodeNumber=node))
    ground = model.AddNode(items.NodePointGround())
    fixed = model.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    moving = model.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
    model.AddObject(items.CoordinateSpringDamper(markerNumbers=[fixed, moving], stiffness=1.0))
    history = model.AddNode(items.NodeGenericData(initialCoordinates=[1.5],
                                                  numberOfDataCoordinates=1))
    # the gap is the second marker's coordinate minus the first one's minus the offset
    model.AddObject(items.ObjectContactCoordinate(
        markerNumbers=[fixed, moving], nodeNumber=history, contactStiffness=stiffness,
        contactDamping=0.0, offset=-0.5))
    sensor = model.AddSensor(items.SensorNode(nodeNumber=node, storeInternal=True,
                                              outputVariableType=exu.OutputVariableType.Coordinates))
    model.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = STEPS
    settings.timeIntegration.endTime = END
    settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = END / SAMPLES
    watch = peer.Clock()
    model.SolveDynamic(settings)
    seconds = watch()
    stored = np.asarray(model.GetSensorStoredData(sensor))
    return seconds, peer.oscillator_error(stored[:, 0], stored[:, 1])


peer.penalty_oscillator('exudyn', run, STEPS)
