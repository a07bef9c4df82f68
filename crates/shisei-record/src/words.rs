//! The words that makers use in column names, lower case, parted by blanks.

/// Acceleration.
pub(crate) const ACC: &str = "acc accel accelerometer acceleration accelero accelerations acce a accs accl specificforce 加速度 \
    加速度計 加速度センサ 加速度センサー gf gforce accelerometers accelorometer linacc acel 加速度计 accelereration \
    beschleunigung accg accms2";
/// Angular rate.
pub(crate) const GYRO: &str = "gyr gyro gyroscope gyros w omega angularvelocity angularrate rotationrate g gyroscopes angvel \
    angrate 角速度 ジャイロ ジャイロセンサ ジャイロセンサー 角速度センサ 角速度センサー ジャイロスコープ 陀螺仪 ω angularvel turnrate drehrate gyrorotation gyroadc gyrorad \
    gyrodps rateofturn";
/// Temperature.
pub(crate) const TEMPERATURE: &str = "temp temperature tmp 温度 気温 温度センサ imutemp temperatur chiptemp";
/// Time.
pub(crate) const TIME: &str = "time timestamp t timestamps seconds secs sec elapsed elapsedtime sampletimefine epoch date \
    datetime clock timeofday micros millis milliseconds microseconds nanoseconds ms us ns 時刻 時間 \
    タイムスタンプ サンプリング時間 サンプリング時刻 計測時間 計測時刻 測定時間 測定時刻 日時 経過時間 时间 utc stamp tick ticks zeit tow gpstime unixtime unix timems timeus times \
    timens timesec timestampms timestampus timestampns systime msec usec datetimestamp sampletime \
    timepoint uptime 日付時刻 timing walltime hosttime devicetime ts";
/// A running number.
pub(crate) const COUNTER: &str = "counter packetcounter count sample samples index idx frame seq sequence framenumber no n number \
    row packet packetnumber samplenumber 番号 サンプル framecount id packetid nr samplecount recordnumber \
    loopiteration samplenum packetnum rowid";
/// Things that are not used.
pub(crate) const OTHER: &str = "mag magn magnetometer magnetic magneticfield magnet compass quat quaternion q roll pitch yaw \
    euler orientation angle velocity vel position pos pressure baro altitude alt latitude longitude \
    lat lon gps battery status delta deltatheta deltavel dq dv stabilized covariance integral \
    humidity light sound speed heading hdg attitude mat rssi label part activity opt bias std var m \
    磁気 地磁気 角加速度 躍度 ヨー ピッチ ロール 姿勢 角度 磁场 motor rc debug setpoint axis error hr ecg emg stride gcp latency accuracy \
    threshold proximity timeofflight norm magnitude total abs jerk rotvec gain scale variance \
    rotation rot rpy heart clipping integration dtheta displacement force moment angleaxis";
/// Words that say gravity was taken out.
pub(crate) const NO_GRAVITY: &str =
    "linear lin user free useracceleration linearacceleration freeacc linearacc 線形";
/// Words that carry nothing.
pub(crate) const FILLER: &str = "sensor imu data value values axis field ns scaled estimated component of the in est compensated \
    motion standardised standardized meas measured vector rs s b body calib calibrated cal uncal \
    uncalibrated raw counts lsb filtered msg 軸 方向 since start smooth from begin x y z smoothed \
    corrected absolute int16 float f32 signal channel ch rate header output hardware device";
